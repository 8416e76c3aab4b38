//! Pictures as people have them: each is read as it looks, or refused with the reason.

use super::*;
use crate::meshes::{Gingerbread, MeshSource as _, NoFiles};
use std::f64::consts::PI;

/// Length of a unit of a drawing \[m\].
const UNIT: f64 = svg::UNIT;

fn drawing(attributes: &str, content: &str) -> Result<Vec<Shape>, OutlineError> {
    read("a.svg", format!("<svg xmlns=\"http://www.w3.org/2000/svg\" {attributes}>{content}</svg>").as_bytes())
}

/// Area of a shape without its holes [square units of a drawing].
fn area(shape: &Shape) -> f64 {
    let holes: f64 = shape.holes.iter().map(|hole| signed_area(hole).abs()).sum();
    (signed_area(&shape.outer).abs() - holes) / (UNIT * UNIT)
}

/// Areas of the shapes and their numbers of holes, checked to a ten-thousandth of the greatest.
fn assert_areas(found: Result<Vec<Shape>, OutlineError>, expected: &[(f64, usize)], what: &str) {
    let found: Vec<_> = found.unwrap().iter().map(|shape| (area(shape), shape.holes.len())).collect();
    let greatest = expected.iter().map(|(area, _)| *area).fold(0.0, f64::max);
    let same = |(a, b): (&(f64, usize), &(f64, usize))| (a.0 - b.0).abs() < 2e-3 * greatest && a.1 == b.1;
    assert!(
        found.len() == expected.len() && found.iter().zip(expected).all(same),
        "{what}: {found:?}, not {expected:?}"
    );
}

#[test]
fn drawings_are_read_as_they_look() {
    let size = "width='100' height='100'";
    let square = "<path d='M10 10h50v50h-50z'/>";
    let cases = [
        ("a path with relative lines", size, square.to_owned(), vec![(2500.0, 0)]),
        (
            "basic shapes",
            size,
            "<rect width='10' height='20'/><circle cx='50' cy='50' r='20'/>".to_owned(),
            vec![(200.0, 0), (400.0 * PI, 0)],
        ),
        ("arcs", size, "<path d='M20 50A30 30 0 1 1 80 50A30 30 0 1 1 20 50Z'/>".to_owned(), vec![(900.0 * PI, 0)]),
        (
            "an ellipse that is turned",
            size,
            "<ellipse cx='50' cy='50' rx='40' ry='10' transform='rotate(30 50 50)'/>".to_owned(),
            vec![(400.0 * PI, 0)],
        ),
        ("curves with short forms", size, "<path d='M0 0Q50 0 50 50T100 100L0 100Z'/>".to_owned(), vec![(5000.0, 0)]),
        (
            "nested groups",
            size,
            format!("<g transform='scale(2)'><g transform='translate(3 4) rotate(90)'>{square}</g></g>"),
            vec![(10_000.0, 0)],
        ),
        (
            "units and a view box",
            "width='2in' height='2in' viewBox='0 0 100 100'",
            square.to_owned(),
            vec![(2500.0 * 1.92 * 1.92, 0)],
        ),
        ("an open path that is filled", size, "<path d='M0 0 40 0 40 40'/>".to_owned(), vec![(800.0, 0)]),
        (
            "a closed line without fill",
            size,
            "<polygon fill='none' stroke='red' points='0,0 30,0 30,30 0,30'/>".to_owned(),
            vec![(900.0, 0)],
        ),
        (
            "a hole by the even-odd rule",
            size,
            "<path fill-rule='evenodd' d='M0 0h60v60h-60zM20 20h20v20h-20z'/>".to_owned(),
            vec![(3200.0, 1)],
        ),
        ("a hole by direction", size, "<path d='M0 0h60v60h-60zM20 20v20h20v-20z'/>".to_owned(), vec![(3200.0, 1)]),
        (
            "no hole in the same direction",
            size,
            "<path d='M0 0h60v60h-60zM20 20h20v20h-20z'/>".to_owned(),
            vec![(3600.0, 0)],
        ),
        (
            "an island in a hole",
            size,
            "<path fill-rule='evenodd' d='M0 0h60v60h-60zM10 10h40v40h-40zM20 20h10v10h-10z'/>".to_owned(),
            vec![(2000.0, 1), (100.0, 0)],
        ),
        (
            "two shapes in one path",
            size,
            "<path d='M0 0h10v10h-10zM50 50h20v20h-20z'/>".to_owned(),
            vec![(100.0, 0), (400.0, 0)],
        ),
        (
            "a shape that is used twice",
            size,
            "<defs><rect id='r' width='10' height='10'/></defs><use href='#r'/><use href='#r' x='50'/>".to_owned(),
            vec![(100.0, 0), (100.0, 0)],
        ),
        (
            "styles and hidden parts",
            size,
            format!(
                "<style>.no{{display:none}}</style><g class='no'>{square}</g><rect width='9' height='9' visibility='hidden'/>{square}"
            ),
            vec![(2500.0, 0)],
        ),
        (
            "repeated points and CRLF",
            size,
            "<path d='M0 0\r\nL0 0 30 0 30 0\r\n30 30 0 30 0 0Z'/>".to_owned(),
            vec![(900.0, 0)],
        ),
    ];
    for (what, attributes, content, expected) in cases {
        assert_areas(drawing(attributes, &content), &expected, what);
    }
}

#[test]
fn drawings_without_an_outline_are_refused_with_the_reason() {
    let reason = |found: Result<Vec<Shape>, OutlineError>| found.unwrap_err().to_string();
    assert!(reason(drawing("", "")).contains("no closed outline"));
    assert!(
        reason(drawing("width='9' height='9'", "<line x2='5' y2='5' stroke='red'/>")).contains("no closed outline")
    );
    assert!(
        reason(drawing("width='9' height='9'", "<path fill='none' stroke='red' d='M0 0 5 0 5 5'/>"))
            .contains("close a line")
    );
    let many: Vec<_> = (0..40).map(|column| format!("<rect x='{}' width='1' height='1'/>", 2 * column)).collect();
    assert!(reason(drawing("width='90' height='9'", &many.concat())).contains("40 separate shapes"));
    // Each line within the one before: refused before each is compared with all others.
    let nested: Vec<_> = (0..5000).map(|at| format!("M{at} {at}h{0}v{0}h-{0}z", 20_000 - 2 * at)).collect();
    assert!(
        reason(drawing("width='9' height='9'", &format!("<path d='{}'/>", nested.concat())))
            .contains("5000 separate shapes or lines")
    );
    assert!(reason(read("a.svg", b"<svg><g>")).contains("no SVG drawing"));
    assert!(reason(read("a.svg", b"\xff\x00")).contains("no SVG drawing"));
    assert!(reason(read("a.png", b"GIF89a")).contains("no PNG picture"));
    assert!(reason(read("a.bmp", b"BM")).contains(".svg or .png"));
}

#[test]
fn shapes_that_are_written_are_read_again() {
    let mesh = Gingerbread::default().build(&NoFiles).unwrap();
    let outer = Shape::of_mesh(&mesh).remove(0).outer;
    let hole: Vec<[f64; 2]> = [[0.45, 0.5], [0.5, 0.55], [0.55, 0.5]].to_vec();
    let shape = Shape { outer: outer.clone(), holes: vec![hole.clone()] };
    let again = read("man.svg", to_svg(std::slice::from_ref(&shape)).as_bytes()).unwrap();
    assert_eq!(again.len(), 1);
    let [low, new_low] = [&shape, &again[0]].map(|shape| crate::meshes::size(&shape.outer));
    assert!((low - new_low).abs() < 1e-6);
    // The drawing begins at its own corner.
    let corner =
        |points: &[[f64; 2]], axis: usize| points.iter().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
    let top = |points: &[[f64; 2]]| points.iter().map(|point| point[1]).fold(f64::NEG_INFINITY, f64::max);
    let shift = [corner(&outer, 0), top(&outer)];
    for (line, found) in [(&outer, &again[0].outer), (&hole, &again[0].holes[0])] {
        assert_eq!(line.len(), found.len());
        for (point, found) in line.iter().zip(found) {
            let miss = [0, 1].map(|axis| (point[axis] - shift[axis] - found[axis]).abs());
            assert!(miss[0].max(miss[1]) < 1e-6, "{point:?} {found:?}");
        }
    }
}

/// A picture of a brightness at each pixel, with so many bytes a pixel.
fn picture(size: u32, color: ::png::ColorType, pixel: impl Fn(f64, f64) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut bytes, size, size);
    encoder.set_color(color);
    let numbers = 0..size * size;
    let pixels = numbers.flat_map(|number| pixel(f64::from(number % size) + 0.5, f64::from(number / size) + 0.5));
    encoder.write_header().unwrap().write_image_data(&pixels.collect::<Vec<_>>()).unwrap();
    bytes
}

#[test]
fn dark_areas_of_pictures_are_traced() {
    // A ring between radii of 20 and 40 pixels, with smooth edges.
    let ring = |x: f64, y: f64| {
        let radius = libm::hypot(x - 50.0, y - 50.0);
        ((radius - 19.5).clamp(0.0, 1.0) - (radius - 39.5).clamp(0.0, 1.0)) * 255.0
    };
    let dark = picture(100, ::png::ColorType::Grayscale, |x, y| vec![255 - ring(x, y) as u8]);
    let light = picture(100, ::png::ColorType::Rgb, |x, y| vec![ring(x, y) as u8; 3]);
    let clear = picture(100, ::png::ColorType::Rgba, |x, y| vec![200, 30, 30, ring(x, y) as u8]);
    for (what, bytes) in [("dark", dark), ("light on dark", light), ("on nothing", clear)] {
        let found = read("ring.PNG", &bytes).unwrap();
        assert!(found.len() == 1 && found[0].holes.len() == 1, "{what}");
        let areas = [&found[0].outer, &found[0].holes[0]].map(|points| signed_area(points).abs() * 1e6);
        for (area, radius) in areas.into_iter().zip([40.0_f64, 20.0]) {
            assert!((area / (PI * radius * radius) - 1.0).abs() < 0.03, "{what}: {areas:?}");
        }
    }
    let grey = picture(20, ::png::ColorType::Grayscale, |_, _| vec![200]);
    assert_eq!(read("grey.png", &grey), Err(OutlineError::Nothing));
    let cut = picture(20, ::png::ColorType::Grayscale, |x, _| vec![if x < 10.0 { 0 } else { 255 }]);
    let half = read("half.png", &cut).unwrap();
    assert!((signed_area(&half[0].outer).abs() * 1e6 - 200.0).abs() < 15.0, "an area at the border is closed there");
}
