//! Tables as CSV: names with commas, quotes or line ends are quoted.

use csv::{QuoteStyle, Writer, WriterBuilder};

/// A table in the making.
pub struct Table {
    head: String,
    writer: Writer<Vec<u8>>,
}

impl Table {
    /// A table with lines above its column names, which begin with `#` and end with a line end, or with none.
    pub fn new(head: String, columns: &[&str]) -> Self {
        let mut table = Self { head, writer: writer(QuoteStyle::Necessary) };
        table.row(columns);
        table
    }

    /// Adds a row.
    pub fn row<T: AsRef<[u8]>>(&mut self, cells: impl IntoIterator<Item = T>) {
        // Writing to memory cannot fail.
        let _ = self.writer.write_record(cells);
    }

    /// The whole text.
    pub fn text(self) -> String {
        self.head + &text(self.writer)
    }
}

/// One row without a line end.
pub fn row<T: AsRef<[u8]>>(cells: impl IntoIterator<Item = T>) -> String {
    record(QuoteStyle::Necessary, cells)
}

/// One cell that is quoted in any case.
pub fn quoted(cell: &str) -> String {
    record(QuoteStyle::Always, [cell])
}

/// A line of a head: what begins with `#` is no row.
pub fn remark(name: &str, value: &str) -> String {
    format!("# {name}: {}\n", crate::terminal::line(&value.replace(['\n', '\r'], " ")))
}

fn record<T: AsRef<[u8]>>(style: QuoteStyle, cells: impl IntoIterator<Item = T>) -> String {
    let mut writer = writer(style);
    let _ = writer.write_record(cells);
    let mut line = text(writer);
    line.truncate(line.trim_end_matches('\n').len());
    line
}

fn writer(style: QuoteStyle) -> Writer<Vec<u8>> {
    // A first cell that begins like a remark is quoted, too.
    WriterBuilder::new().quote_style(style).comment(Some(b'#')).flexible(true).from_writer(Vec::new())
}

fn text(writer: Writer<Vec<u8>>) -> String {
    writer.into_inner().map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default()
}
