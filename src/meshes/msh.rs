//! Reader of text files of Gmsh, versions 2 and 4.1: nodes and the triangles and quadrangles among the elements.
//! Format: Geuzaine and Remacle, *Gmsh Reference Manual*, section "MSH file format".

use super::obj::Reader;

/// First line of such a file.
pub(super) const HEAD: &str = "$MeshFormat";

/// What may be wrong in a line: its number, and the reason.
type Wrong = (usize, String);

/// Numbers of corners of an element by its type; `None` if it is passed over, such as a point or a line.
fn corners(kind: i64) -> Result<Option<usize>, String> {
    match kind {
        1 | 8 | 15 | 26 | 27 | 28 => Ok(None),
        // Nodes on the sides follow the corners.
        2 | 9 | 20..=25 => Ok(Some(3)),
        3 | 10 | 16 | 36 | 37 => Ok(Some(4)),
        4..=7 | 11..=14 | 17..=19 | 29..=31 => {
            Err("a solid element; expected triangles and quadrangles in a plane".to_owned())
        }
        _ => Err(format!("expected an element of type 1 to 31, got {kind}")),
    }
}

/// Lines of a file with their numbers from 1, read one number after another.
struct Lines<'a> {
    lines: std::iter::Zip<std::str::Lines<'a>, std::ops::RangeFrom<usize>>,
    /// Number of the last line.
    at: usize,
}

impl<'a> Lines<'a> {
    /// The next line that is not empty.
    fn next(&mut self) -> Result<&'a str, Wrong> {
        for (line, number) in self.lines.by_ref() {
            self.at = number;
            if !line.trim().is_empty() {
                return Ok(line.trim());
            }
        }
        Err((self.at, "the file ends here, within a section".to_owned()))
    }

    fn wrong(&self, why: impl Into<String>) -> Wrong {
        (self.at, why.into())
    }

    /// The numbers of the next line, at least `count`.
    fn numbers<T: std::str::FromStr>(&mut self, count: usize, what: &str) -> Result<Vec<T>, Wrong> {
        let line = self.next()?;
        let numbers: Option<Vec<T>> = line.split_whitespace().map(|word| word.parse().ok()).collect();
        numbers.filter(|all| all.len() >= count).ok_or_else(|| {
            let line: String = line.chars().take(40).collect();
            self.wrong(format!("expected {what}, got `{line}`"))
        })
    }

    /// Passes over a section, to its end.
    fn skip(&mut self, end: &str) -> Result<(), Wrong> {
        while self.next()? != end {}
        Ok(())
    }
}

/// Numbers of points from 1, by those of their nodes in the file, which may have gaps.
type Nodes = std::collections::BTreeMap<i64, i64>;

/// Reads a file into vertices and faces.
pub(super) fn read(text: &str) -> Result<Reader, Wrong> {
    let mut lines = Lines { lines: text.lines().zip(1..), at: 0 };
    let (mut reader, mut nodes, mut version) = (Reader::default(), Nodes::new(), 0.0);
    let mut elements = Vec::new();
    while let Ok(section) = lines.next() {
        match section {
            HEAD => version = format(&mut lines)?,
            "$Nodes" if version < 4.0 => nodes_2(&mut lines, &mut reader, &mut nodes)?,
            "$Nodes" => nodes_4(&mut lines, &mut reader, &mut nodes)?,
            "$Elements" if version < 4.0 => elements_2(&mut lines, &mut elements)?,
            "$Elements" => elements_4(&mut lines, &mut elements)?,
            other => match other.strip_prefix('$') {
                Some(name) => {
                    lines.skip(&format!("$End{name}"))?;
                    continue;
                }
                None => {
                    return Err(lines.wrong(format!("expected the begin of a section, such as $Nodes, got `{other}`")));
                }
            },
        }
        let end = format!("$End{}", &section[1..]);
        if lines.next()? != end {
            return Err(lines.wrong(format!("expected {end}")));
        }
    }
    for (line, corners) in elements {
        let point =
            |node: &i64| nodes.get(node).copied().ok_or_else(|| (line, format!("node {node} is not in the file")));
        let face = corners.iter().map(point).collect::<Result<_, _>>()?;
        reader.add_face(line, face);
    }
    if reader.is_without_faces() {
        return Err((lines.at, "the file has no triangle or quadrangle".to_owned()));
    }
    // Nodes of points and lines, and those on the sides of triangles, belong to no corner.
    reader.drop_unused();
    Ok(reader)
}

fn format(lines: &mut Lines<'_>) -> Result<f64, Wrong> {
    let numbers: Vec<f64> = lines.numbers(2, "a version, 0 for text, and the size of a number")?;
    let version = numbers[0];
    if numbers[1] != 0.0 {
        return Err(lines.wrong("a binary file; save it as text (ASCII)"));
    }
    if !(2.0..3.0).contains(&version) && version != 4.1 {
        return Err(lines.wrong(format!("expected version 2 or 4.1, got {version}")));
    }
    Ok(version)
}

fn count(lines: &mut Lines<'_>, place: usize, what: &str) -> Result<usize, Wrong> {
    let numbers: Vec<usize> = lines.numbers(place + 1, what)?;
    Ok(numbers[place])
}

fn add_node(
    lines: &Lines<'_>,
    (reader, nodes): (&mut Reader, &mut Nodes),
    node: i64,
    place: &[f64],
) -> Result<(), Wrong> {
    if !place.iter().all(|coordinate| coordinate.is_finite()) {
        return Err(lines.wrong("expected finite coordinates"));
    }
    if nodes.insert(node, i64::try_from(nodes.len() + 1).unwrap_or(i64::MAX)).is_some() {
        return Err(lines.wrong(format!("node {node} is there twice")));
    }
    reader.add_point(lines.at, [place[0], place[1], place[2]]);
    Ok(())
}

fn nodes_2(lines: &mut Lines<'_>, reader: &mut Reader, nodes: &mut Nodes) -> Result<(), Wrong> {
    for _ in 0..count(lines, 0, "the number of nodes")? {
        let numbers: Vec<f64> = lines.numbers(4, "the number of a node, x, y and z")?;
        add_node(lines, (reader, nodes), numbers[0] as i64, &numbers[1..4])?;
    }
    Ok(())
}

fn nodes_4(lines: &mut Lines<'_>, reader: &mut Reader, nodes: &mut Nodes) -> Result<(), Wrong> {
    for _ in 0..count(lines, 0, "the numbers of blocks and nodes")? {
        let count =
            count(lines, 3, "the dimension, the tag and whether a block is parametric, and its number of nodes")?;
        let mut numbers = Vec::new();
        for _ in 0..count {
            let number: Vec<i64> = lines.numbers(1, "the number of a node")?;
            numbers.push(number[0]);
        }
        for node in numbers {
            let place: Vec<f64> = lines.numbers(3, "x, y and z of a node")?;
            add_node(lines, (reader, nodes), node, &place)?;
        }
    }
    Ok(())
}

fn elements_2(lines: &mut Lines<'_>, elements: &mut Vec<(usize, Vec<i64>)>) -> Result<(), Wrong> {
    for _ in 0..count(lines, 0, "the number of elements")? {
        let numbers: Vec<i64> = lines.numbers(3, "the number, the type and the tags of an element, and its nodes")?;
        let Some(count) = corners(numbers[1]).map_err(|why| lines.wrong(why))? else { continue };
        let first = usize::try_from(numbers[2]).unwrap_or(usize::MAX).saturating_add(3);
        let nodes = numbers.get(first..first.saturating_add(count));
        let nodes = nodes.ok_or_else(|| lines.wrong(format!("expected {count} nodes after the tags")))?;
        elements.push((lines.at, nodes.to_vec()));
    }
    Ok(())
}

fn elements_4(lines: &mut Lines<'_>, elements: &mut Vec<(usize, Vec<i64>)>) -> Result<(), Wrong> {
    for _ in 0..count(lines, 0, "the numbers of blocks and elements")? {
        let block: Vec<i64> =
            lines.numbers(4, "the dimension, the tag and the type of a block, and its number of elements")?;
        let corners = corners(block[2]).map_err(|why| lines.wrong(why))?;
        for _ in 0..block[3] {
            let numbers: Vec<i64> =
                lines.numbers(1 + corners.unwrap_or(0), "the number of an element, and its nodes")?;
            elements.extend(corners.map(|count| (lines.at, numbers[1..=count].to_vec())));
        }
    }
    Ok(())
}
