//! Tables as CSV. Names with commas, quotes or line ends are quoted.
//!
//! ```
//! use gingerbread::table::Table;
//!
//! let mut table = Table::new("# a table\n".to_owned(), &["name", "value"]);
//! table.row(["a, b", "1"]);
//! assert_eq!(table.text(), "# a table\nname,value\n\"a, b\",1\n");
//! ```

use csv::{QuoteStyle, Writer, WriterBuilder};

/// Table under construction.
pub struct Table {
    head: String,
    writer: Writer<Vec<u8>>,
}

impl Table {
    /// Table with header lines above its column names. They begin with `#` and end with a line end. The header may be
    /// empty.
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

    /// Text of the whole table.
    pub fn text(self) -> String {
        self.head + &text(self.writer)
    }
}

/// One row without a line end.
pub fn row<T: AsRef<[u8]>>(cells: impl IntoIterator<Item = T>) -> String {
    record(QuoteStyle::Necessary, cells)
}

/// One cell, always quoted.
pub fn quoted(cell: &str) -> String {
    record(QuoteStyle::Always, [cell])
}

/// Header line. A line that begins with `#` is not a row.
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
    // A first cell that begins like a header line is also quoted.
    WriterBuilder::new().quote_style(style).comment(Some(b'#')).flexible(true).from_writer(Vec::new())
}

fn text(writer: Writer<Vec<u8>>) -> String {
    writer.into_inner().map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default()
}
