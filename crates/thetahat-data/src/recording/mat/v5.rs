//! Variables of MAT files of version 5.

use std::borrow::Cow;
use std::path::Path;

use flate2::read::ZlibDecoder;

use super::super::budget::Budget;
use super::super::error::RecordingError;
use super::super::table::{Column, RequestedColumns};
use super::elements::{ByteOrder, COMPRESSED, Element, MATRIX, elements};
use super::kinds::{MOST_CELLS, NOT_VECTORS, kind_of_object, of_cells};
use super::shape::samples_and_channels;

/// Length of the header, after which the variables follow.
const HEADER: usize = 128;
/// Deepest nesting of structures.
const DEEPEST_STRUCTURE: usize = 8;

/// The variables of a file. Variables that are not requested have a name and no values.
pub(super) fn read(bytes: &[u8], path: &Path, wanted: RequestedColumns<'_>) -> Result<Vec<Column>, RecordingError> {
    let order = byte_order(bytes, path)?;
    let damaged = |offset: usize| cut_or_damaged(path, HEADER + offset);
    let budget = Budget::of(path, bytes.len() as u64);
    let mut reader = Reader { path, order, wanted, budget, columns: Vec::new() };
    for element in elements(&bytes[HEADER..], order).map_err(damaged)? {
        let matrix = reader.decompressed(&element)?;
        reader.add(None, &matrix, 0).map_err(|problem| problem.unwrap_or_else(|| damaged(element.offset)))?;
    }
    Ok(reader.columns)
}

/// The byte order that the header states.
fn byte_order(bytes: &[u8], path: &Path) -> Result<ByteOrder, RecordingError> {
    match bytes.get(HEADER - 4..HEADER) {
        Some([0, 1, b'I', b'M']) => Ok(ByteOrder::Little),
        Some([1, 0, b'M', b'I']) => Ok(ByteOrder::Big),
        _ => Err(RecordingError::NotMat { file: path.into() }),
    }
}

fn cut_or_damaged(path: &Path, offset: usize) -> RecordingError {
    RecordingError::damaged(path, format!("its parts do not fit into it from byte {offset} on"))
}

struct Reader<'a> {
    path: &'a Path,
    order: ByteOrder,
    wanted: RequestedColumns<'a>,
    budget: Budget,
    columns: Vec<Column>,
}

/// What is wrong with a variable; none means that its elements do not fit.
type Problem = Option<RecordingError>;

impl Reader<'_> {
    /// The content of an element that is a variable, compressed or not.
    fn decompressed<'b>(&self, element: &Element<'b>) -> Result<Cow<'b, [u8]>, RecordingError> {
        let damaged = || cut_or_damaged(self.path, HEADER + element.offset);
        match element.kind {
            MATRIX => Ok(Cow::Borrowed(element.data)),
            COMPRESSED => {
                let bytes = self.budget.decompress("a compressed variable", ZlibDecoder::new(element.data));
                let bytes = bytes.map_err(|e| e.at(self.path, "a compressed variable"))?;
                self.inside(&bytes).map(Cow::Owned).ok_or_else(damaged)
            }
            _ => Err(damaged()),
        }
    }

    /// The content of the only variable in compressed bytes.
    fn inside(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        match elements(bytes, self.order).ok()?.as_slice() {
            [only] if only.kind == MATRIX => Some(only.data.to_vec()),
            _ => None,
        }
    }

    /// Adds a variable from its content, or a field of a structure by its name in the structure.
    fn add(&mut self, field: Option<String>, inside: &[u8], depth: usize) -> Result<(), Problem> {
        if field.is_some() && inside.is_empty() {
            return Ok(());
        }
        let elements = elements(inside, self.order).map_err(|_| None)?;
        if let Some((name, class)) = object(&elements, self.order) {
            self.columns.push(Column::of_kind(field.unwrap_or(name), kind_of_object(&class)));
            return Ok(());
        }
        let matrix = Matrix::of(&elements, self.order).ok_or(None)?;
        // The content of objects follows the variables, without a name.
        if field.is_none() && matrix.name.is_empty() {
            return Ok(());
        }
        let name = field.unwrap_or_else(|| matrix.name.clone());
        match matrix.class {
            CELL => {
                let column = self.cell(name, &matrix, &elements[3..])?;
                self.columns.push(column);
                Ok(())
            }
            STRUCTURE if depth < DEEPEST_STRUCTURE && matrix.shape.iter().all(|&n| n == 1) => {
                self.add_fields(&name, &elements[3..], depth + 1)
            }
            _ => {
                let column = self.column(name, &matrix)?;
                self.columns.push(column);
                Ok(())
            }
        }
    }

    /// Adds the fields of a structure: the length of names, the names, then a matrix for each field.
    fn add_fields(&mut self, name: &str, elements: &[Element], depth: usize) -> Result<(), Problem> {
        let [length, names, fields @ ..] = elements else { return Err(None) };
        let length = self.order.word(length.data, 0).and_then(|n| usize::try_from(n).ok()).filter(|n| *n > 0);
        let names = names.data.chunks_exact(length.ok_or(None)?);
        if names.len() != fields.len() || fields.iter().any(|field| field.kind != MATRIX) {
            return Err(None);
        }
        for (field_name, field) in names.zip(fields) {
            self.add(Some(format!("{name}.{}", text(field_name))), field.data, depth)?;
        }
        Ok(())
    }

    /// A cell array of vectors of one length: a channel for each cell.
    fn cell(&mut self, name: String, matrix: &Matrix, cells: &[Element]) -> Result<Column, Problem> {
        let count = matrix.shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
        if count != Some(cells.len()) {
            return Err(None);
        }
        if !(1..=MOST_CELLS).contains(&cells.len()) {
            return Ok(Column::of_kind(name, NOT_VECTORS));
        }
        if !self.wanted.includes(&name) {
            return Ok(Column::of_numbers(name, 0, Vec::new()));
        }
        let mut vectors = Vec::new();
        for cell in cells {
            let inside = elements(cell.data, self.order).map_err(|_| None)?;
            let Some(matrix) = Matrix::of(&inside, self.order).filter(Matrix::is_vector) else {
                return Ok(Column::of_kind(name, NOT_VECTORS));
            };
            let column = self.column(name.clone(), &matrix)?;
            vectors.push(column.values);
        }
        Ok(of_cells(name, vectors))
    }

    fn column(&mut self, name: String, matrix: &Matrix) -> Result<Column, Problem> {
        if let Some(kind) = matrix.kind_not_read() {
            return Ok(Column::of_kind(name, kind));
        }
        let Some((samples, channels)) = samples_and_channels(&matrix.shape) else {
            return Ok(Column::of_kind(name, format!("an array of {} dimensions", matrix.shape.len())));
        };
        if !self.wanted.includes(&name) {
            return Ok(Column::of_numbers(name, 0, Vec::new()));
        }
        let count = self.budget.take(&format!("variable {name:?}"), &[samples, channels]).map_err(Some)?;
        let Some(data) = matrix.data.filter(|data| data.count() == Some(count)) else {
            return Err(Some(self.miscounted(&name, count, matrix.data)));
        };
        Ok(Column::of_numbers(name, channels, data.numbers(self.order).ok_or(None)?))
    }

    fn miscounted(&self, name: &str, expected: usize, data: Option<&Element>) -> RecordingError {
        let found = data.and_then(Element::count).unwrap_or_default();
        let reason = format!("variable {name:?} has the size of {expected} values and holds {found}");
        RecordingError::damaged(self.path, reason)
    }
}

const CELL: u8 = 1;
const STRUCTURE: u8 = 2;
/// An object of a class, whose elements are flags, its name, the kind of system and the name of the class.
const OPAQUE: u8 = 17;

/// The name and class of a variable that is an object.
fn object(elements: &[Element], order: ByteOrder) -> Option<(String, String)> {
    let [flags, name, _, class, ..] = elements else { return None };
    let [kind, ..] = order.word(flags.data, 0)?.to_le_bytes();
    (kind == OPAQUE).then(|| (text(name.data), text(class.data)))
}

/// A variable: flags, size and name, then its numbers or other content.
struct Matrix<'a> {
    class: u8,
    complex: bool,
    shape: Vec<usize>,
    name: String,
    data: Option<&'a Element<'a>>,
}

impl<'a> Matrix<'a> {
    fn of(elements: &'a [Element<'a>], order: ByteOrder) -> Option<Self> {
        let [flags, size, name, rest @ ..] = elements else { return None };
        let flags = order.word(flags.data, 0)?;
        let side = |i| usize::try_from(order.word(size.data, 4 * i)?).ok();
        let shape: Vec<usize> = (0..size.data.len() / 4).map(side).collect::<Option<_>>()?;
        let [class, kinds, ..] = flags.to_le_bytes();
        Some(Self { class, complex: kinds & 0x08 != 0, shape, name: text(name.data), data: rest.first() })
    }

    fn is_vector(&self) -> bool {
        self.kind_not_read().is_none() && matches!(self.shape[..], [1, _] | [_, 1])
    }

    /// The kind of the variable, if it is not an array of real numbers.
    fn kind_not_read(&self) -> Option<&'static str> {
        match self.class {
            CELL => Some(NOT_VECTORS),
            STRUCTURE => Some("an array of structures"),
            4 => Some("text"),
            5 => Some("a sparse matrix"),
            6..=15 if self.complex => Some("complex"),
            6..=15 => None,
            _ => Some("an object"),
        }
    }
}

/// A name, which ends at the first zero.
fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}
