//! Records of the compact protocol of Apache Thrift, which describe a Parquet file and each of its pages.
//!
//! The library reserves memory by the counts in these records, follows nested groups recursively, and does not check whether a field has
//! the expected type. Therefore each record is first compared with the expected [`Record`]; the records of Parquet are in `records`.
//! Source: thrift-compact-protocol.md of Apache Thrift.

/// Deepest nesting of records with unknown fields.
const DEEPEST: usize = 16;

/// The type of a field.
pub(super) enum Kind {
    Bool,
    Byte,
    I16,
    I32,
    I64,
    Double,
    Binary,
    List(&'static Kind),
    Record(&'static Record),
}

/// A record: its name, and its fields by number.
pub(super) struct Record {
    pub(super) name: &'static str,
    pub(super) fields: &'static [(i64, Kind)],
}

/// Receives the name of a record, the number of a field and its value if it is an integer; at the end of the record zero and zero. None
/// ends the walk.
pub(super) type Visit<'t> = &'t mut dyn FnMut(&'static str, i64, i64) -> Option<()>;

/// Reads records byte by byte. Each step returns none if the bytes end or are not of the expected kind.
pub(super) struct Thrift<'a> {
    rest: &'a [u8],
}

impl<'a> Thrift<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Walks over a record of a kind. Unknown fields are skipped.
    pub(super) fn record(&mut self, record: &'static Record, visit: Visit<'_>) -> Option<()> {
        let mut number = 0_i64;
        while let Some((next, code)) = self.field(number)? {
            number = next;
            match record.fields.iter().find(|(known, _)| *known == number) {
                None => self.pass(code, 0)?,
                Some((_, kind)) if !kind.is_written_as(code) => return None,
                Some((_, kind)) => {
                    let value = self.value(kind, false, visit)?;
                    visit(record.name, number, value)?;
                }
            }
        }
        visit(record.name, 0, 0)
    }

    /// The number and code of the next field, or none at the end of the record.
    fn field(&mut self, before: i64) -> Option<Option<(i64, u8)>> {
        let head = self.byte()?;
        if head == 0 {
            return Some(None);
        }
        let number = match head >> 4 {
            0 => self.integer()?,
            delta => before.checked_add(delta.into())?,
        };
        Some(Some((number, head & 0x0f)))
    }

    /// A value of a kind; zero if it is not an integer.
    fn value(&mut self, kind: &'static Kind, in_list: bool, visit: Visit<'_>) -> Option<i64> {
        match kind {
            Kind::Bool if in_list => return None,
            Kind::Bool => {}
            Kind::Byte => self.skip(1)?,
            Kind::I16 | Kind::I32 | Kind::I64 => return self.integer(),
            Kind::Double => self.skip(8)?,
            Kind::Binary => self.skip_binary()?,
            Kind::Record(record) => self.record(record, visit)?,
            Kind::List(element) => {
                let (count, code) = self.list()?;
                if count > 0 && !element.is_written_as(code) {
                    return None;
                }
                for _ in 0..count {
                    self.value(element, true, visit)?;
                }
            }
        }
        Some(0)
    }

    /// Skips the value of an unknown field.
    fn pass(&mut self, code: u8, depth: usize) -> Option<()> {
        match code {
            1 | 2 => Some(()),
            3 => self.skip(1),
            4..=6 => self.integer().map(|_| ()),
            7 => self.skip(8),
            8 => self.skip_binary(),
            9 | 10 if depth < DEEPEST => {
                let (count, code) = self.list()?;
                (0..count).try_for_each(|_| self.pass(code, depth + 1))
            }
            12 if depth < DEEPEST => {
                while let Some((_, code)) = self.field(0)? {
                    self.pass(code, depth + 1)?;
                }
                Some(())
            }
            _ => None,
        }
    }

    /// The number of elements of a list, at most the number of remaining bytes, and the code of their type.
    fn list(&mut self) -> Option<(usize, u8)> {
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.length()? } else { usize::from(head >> 4) };
        (count <= self.rest.len()).then_some((count, head & 0x0f))
    }

    fn byte(&mut self) -> Option<u8> {
        let (&byte, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(byte)
    }

    fn skip(&mut self, bytes: usize) -> Option<()> {
        self.rest = self.rest.get(bytes..)?;
        Some(())
    }

    fn skip_binary(&mut self) -> Option<()> {
        let length = self.length()?;
        self.skip(length)
    }

    fn length(&mut self) -> Option<usize> {
        usize::try_from(self.variable()?).ok()
    }

    /// A number in seven bits a byte, the lowest first.
    fn variable(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    /// An integer whose last bit is its sign.
    fn integer(&mut self) -> Option<i64> {
        let number = self.variable()?;
        Some((number >> 1) as i64 ^ -((number & 1) as i64))
    }
}

impl Kind {
    fn is_written_as(&self, code: u8) -> bool {
        match self {
            Self::Bool => matches!(code, 1 | 2),
            Self::Byte => code == 3,
            Self::I16 => code == 4,
            Self::I32 => code == 5,
            Self::I64 => code == 6,
            Self::Double => code == 7,
            Self::Binary => code == 8,
            Self::List(_) => code == 9,
            Self::Record(_) => code == 12,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static RECORD: Record =
        Record { name: "r", fields: &[(1, Kind::I32), (2, Kind::List(&Kind::Binary)), (5, Kind::I32)] };

    fn walk(bytes: &[u8]) -> Option<Vec<(i64, i64)>> {
        let mut found = Vec::new();
        let mut visit = |_, field, value| {
            found.push((field, value));
            Some(())
        };
        Thrift::new(bytes).record(&RECORD, &mut visit)?;
        Some(found)
    }

    #[test]
    fn integers_alternate_in_sign() {
        assert_eq!(walk(&[0x15, 0x02, 0x45, 0x80, 0x01, 0x00]).unwrap(), [(1, 1), (5, 64), (0, 0)]);
        assert_eq!(walk(&[0x15, 0x03, 0x00]).unwrap(), [(1, -2), (0, 0)]);
    }

    #[test]
    fn fields_that_are_not_known_are_passed_over() {
        assert_eq!(walk(&[0x37, 0, 0, 0, 0, 0, 0, 0, 0, 0x25, 0x02, 0x00]).unwrap(), [(5, 1), (0, 0)]);
    }

    #[test]
    fn field_of_another_type() {
        assert!(walk(&[0x17, 0, 0, 0, 0, 0, 0, 0, 0, 0x00]).is_none());
        assert!(walk(&[0x29, 0x15, 0x02, 0x00]).is_none());
    }

    #[test]
    fn records_without_end() {
        assert!(walk(&[0x3c; 100_000]).is_none());
    }

    #[test]
    fn lengths_beyond_the_bytes() {
        for bytes in
            [&[0x38, 0xff, 0xff, 0xff, 0x7f][..], &[0x29, 0xf8, 0xff, 0xff, 0xff, 0x7f], &[0x39, 0xf1, 0x7f, 0x55]]
        {
            assert!(walk(bytes).is_none(), "{bytes:?}");
        }
    }
}
