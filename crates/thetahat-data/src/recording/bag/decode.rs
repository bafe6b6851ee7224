//! The numbers of a message by its schema, with the lengths and texts that say which signal each of them is.

use super::cursor::Cursor;
use super::schema::{Count, Encoding, Field, Kind, LONGEST_NAME, Role, Schema, is_header};

/// Longest array whose elements are signals: longer ones are images, scans and the like.
pub(super) const MOST_ELEMENTS: usize = 1024;
/// Largest number of signals, sequences and names of a message.
const MOST_VALUES: usize = 8192;
/// Deepest nesting of messages.
const DEEPEST: usize = 16;
/// Fields that any message may have, and more for each of its bytes: empty types take no bytes.
const STEPS: usize = 1024;
const STEPS_A_BYTE: usize = 32;

/// What a message holds.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Decoded<'a> {
    /// Time of the header in nanoseconds.
    pub(super) stamp_ns: Option<i64>,
    /// The numbers, in the order of the fields.
    pub(super) values: Vec<f64>,
    /// The length of each sequence.
    pub(super) lengths: Vec<usize>,
    /// The texts that may be names.
    pub(super) texts: Vec<&'a str>,
    /// Number of bytes after the message.
    pub(super) left: usize,
}

/// Decodes a message, or says what is wrong with it.
pub(super) fn decode<'a>(schema: &Schema, message: &'a [u8]) -> Result<Decoded<'a>, String> {
    let cursor = Cursor::of(message, schema.encoding)?;
    let steps = STEPS + STEPS_A_BYTE * message.len();
    let mut decoder = Decoder { schema, cursor, steps, decoded: Decoded::default() };
    decoder.message(0, Place { depth: 0, has_stamp: true, in_list: false })?;
    decoder.decoded.left = decoder.cursor.left();
    Ok(decoder.decoded)
}

/// Whether a field of one text names what the others of its message belong to.
pub(super) fn is_name(field: &Field) -> bool {
    field.kind == Kind::Text && field.count == Count::One && matches!(field.name.as_str(), "name" | "joint_name")
}

/// Where a message is inside of another.
#[derive(Clone, Copy)]
struct Place {
    depth: usize,
    /// Whether its stamp is that of the whole message.
    has_stamp: bool,
    /// Whether it is an element of an array.
    in_list: bool,
}

struct Decoder<'s, 'a> {
    schema: &'s Schema,
    cursor: Cursor<'a>,
    /// Fields still allowed.
    steps: usize,
    decoded: Decoded<'a>,
}

impl<'a> Decoder<'_, 'a> {
    fn message(&mut self, of: usize, place: Place) -> Result<(), String> {
        if place.depth > DEEPEST {
            return Err(format!("its types are nested more than {DEEPEST} deep"));
        }
        let schema = self.schema;
        for field in schema.fields(of) {
            self.step()?;
            self.field(field, place)?;
        }
        Ok(())
    }

    fn step(&mut self) -> Result<(), String> {
        self.steps = self.steps.checked_sub(1).ok_or("it has far more fields than bytes")?;
        Ok(())
    }

    fn field(&mut self, field: &Field, place: Place) -> Result<(), String> {
        match field.count {
            Count::One => self.one(field, place),
            Count::Fixed(count) => self.array(field, count, place),
            Count::Sequence => {
                let count = self.cursor.length().ok_or_else(|| ends(field))?;
                self.decoded.lengths.push(count);
                self.require_few(self.decoded.lengths.len(), "sequences")?;
                self.array(field, count, place)
            }
        }
    }

    fn one(&mut self, field: &Field, place: Place) -> Result<(), String> {
        match field.kind {
            Kind::Text => {
                let text = self.cursor.text().ok_or_else(|| ends(field))?;
                if place.in_list && is_name(field) { self.push_text(text, field) } else { Ok(()) }
            }
            Kind::Message(of) => {
                let has_stamp = place.depth == 0 && is_header(field);
                self.message(of, Place { depth: place.depth + 1, has_stamp, in_list: place.in_list })
            }
            Kind::Time if field.role == Role::Stamp => {
                let time = self.cursor.time_ns().ok_or_else(|| ends(field))?;
                if place.has_stamp {
                    self.decoded.stamp_ns.get_or_insert(time);
                }
                Ok(())
            }
            Kind::Number(_) | Kind::WideText | Kind::Time | Kind::Duration => {
                let value = self.element(field)?;
                if field.role == Role::Value { self.push(value) } else { Ok(()) }
            }
        }
    }

    fn push(&mut self, value: Option<f64>) -> Result<(), String> {
        self.decoded.values.extend(value);
        self.require_few(self.decoded.values.len(), "numbers")
    }

    fn require_few(&self, count: usize, what: &str) -> Result<(), String> {
        if count <= MOST_VALUES { Ok(()) } else { Err(format!("it has more than {MOST_VALUES} {what}")) }
    }

    fn array(&mut self, field: &Field, count: usize, place: Place) -> Result<(), String> {
        // Each element takes a byte at least; only empty types of ROS 1 take none.
        if count > self.cursor.left() && (field.count == Count::Sequence || self.schema.encoding == Encoding::Cdr) {
            return Err(format!("its {:?} has {count} elements, more than it has bytes", field.name));
        }
        match field.kind {
            Kind::Number(number) if count > MOST_ELEMENTS => self.cursor.skip(number, count).ok_or_else(|| ends(field)),
            Kind::Number(_) | Kind::Time | Kind::Duration | Kind::WideText => self.elements(field, count),
            Kind::Text => self.texts(field, count),
            Kind::Message(of) => {
                let place = Place { depth: place.depth + 1, has_stamp: false, in_list: true };
                (0..count).try_for_each(|_| {
                    self.step()?;
                    self.message(of, place)
                })
            }
        }
    }

    fn elements(&mut self, field: &Field, count: usize) -> Result<(), String> {
        for _ in 0..count {
            let value = self.element(field)?;
            if count <= MOST_ELEMENTS {
                self.push(value)?;
            }
        }
        Ok(())
    }

    fn texts(&mut self, field: &Field, count: usize) -> Result<(), String> {
        for _ in 0..count {
            let text = self.cursor.text().ok_or_else(|| ends(field))?;
            if count <= MOST_ELEMENTS {
                self.push_text(text, field)?;
            }
        }
        Ok(())
    }

    /// Keeps a text that may be a name; an empty one if it is too long for a name.
    fn push_text(&mut self, bytes: &'a [u8], field: &Field) -> Result<(), String> {
        let text = str::from_utf8(bytes).map_err(|_| format!("its {:?} is not text", field.name))?;
        self.decoded.texts.push(if text.len() > LONGEST_NAME { "" } else { text });
        self.require_few(self.decoded.texts.len(), "texts")
    }

    /// A number, or a time in seconds; none of a text.
    fn element(&mut self, field: &Field) -> Result<Option<f64>, String> {
        let value = match field.kind {
            Kind::Number(number) => self.cursor.number(number),
            Kind::Time => self.cursor.time_ns().map(|time| time as f64 * 1e-9),
            Kind::Duration => self.cursor.duration(),
            Kind::WideText => return self.wide_text(field).map(|()| None),
            Kind::Text | Kind::Message(_) => return Ok(None),
        };
        value.map(Some).ok_or_else(|| ends(field))
    }

    /// Writers differ in the size of a wide character, so that only an empty text can be passed over.
    fn wide_text(&mut self, field: &Field) -> Result<(), String> {
        match self.cursor.length().ok_or_else(|| ends(field))? {
            0 => Ok(()),
            _ => Err(format!("its {:?} is a text of wide characters (wstring), which is not read", field.name)),
        }
    }
}

fn ends(field: &Field) -> String {
    format!("it ends within its {:?}", field.name)
}
