//! Records of the compact protocol of Apache Thrift, which describe a Parquet file and each of its pages.
//!
//! The library reserves memory by the counts in these records and follows nested groups by calling itself. Forged counts
//! are found here first.
//! Source: thrift-compact-protocol.md of Apache Thrift, and parquet.thrift of Apache Parquet.

/// Records within records.
const DEEPEST: usize = 16;

/// Where a record is read, byte by byte. Each step is none where the bytes end or do not make sense.
pub(super) struct Thrift<'a> {
    rest: &'a [u8],
}

/// A value of a field.
pub(super) enum Value<'a> {
    /// A whole number.
    Integer(i64),
    /// A list of records, each at the beginning of `rest` after the one before; see [`Thrift::next_record`].
    Records(usize, Thrift<'a>),
    /// Something else, passed over.
    Other,
}

impl<'a> Thrift<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Passes over one record and tells of each field its number and value.
    pub(super) fn record(&mut self, tell: &mut dyn FnMut(i64, Value<'a>) -> Option<()>) -> Option<()> {
        self.fields(0, tell)
    }

    fn fields(&mut self, depth: usize, tell: &mut dyn FnMut(i64, Value<'a>) -> Option<()>) -> Option<()> {
        let mut field = 0_i64;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            field = match head >> 4 {
                0 => self.integer()?,
                delta => field.checked_add(delta.into())?,
            };
            let value = self.value(head & 0x0f, false, depth)?;
            tell(field, value)?;
        }
    }

    fn value(&mut self, kind: u8, in_list: bool, depth: usize) -> Option<Value<'a>> {
        match kind {
            1 | 2 if in_list => self.skip(1)?,
            1 | 2 => {}
            3 => self.skip(1)?,
            4..=6 => return self.integer().map(Value::Integer),
            7 => self.skip(8)?,
            8 => {
                let length = self.length()?;
                self.skip(length)?;
            }
            9 | 10 => return self.list(depth),
            11 => self.map(depth)?,
            12 if depth < DEEPEST => self.fields(depth + 1, &mut |_, _| Some(()))?,
            _ => return None,
        }
        Some(Value::Other)
    }

    fn list(&mut self, depth: usize) -> Option<Value<'a>> {
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.length()? } else { usize::from(head >> 4) };
        let kind = head & 0x0f;
        let records = Thrift { rest: self.rest };
        if count > self.rest.len() || depth >= DEEPEST {
            return None;
        }
        for _ in 0..count {
            self.value(kind, true, depth + 1)?;
        }
        Some(if kind == 12 { Value::Records(count, records) } else { Value::Other })
    }

    fn map(&mut self, depth: usize) -> Option<()> {
        let count = self.length()?;
        if count == 0 {
            return Some(());
        }
        let kinds = self.byte()?;
        if count > self.rest.len() || depth >= DEEPEST {
            return None;
        }
        for _ in 0..count {
            self.value(kinds >> 4, true, depth + 1)?;
            self.value(kinds & 0x0f, true, depth + 1)?;
        }
        Some(())
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

    /// A whole number whose last bit is its sign.
    fn integer(&mut self) -> Option<i64> {
        let number = self.variable()?;
        Some((number >> 1) as i64 ^ -((number & 1) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_alternate_in_sign() {
        let mut found = Vec::new();
        let mut tell = |field, value| {
            if let Value::Integer(number) = value {
                found.push((field, number));
            }
            Some(())
        };
        Thrift::new(&[0x15, 0x02, 0x15, 0x03, 0x35, 0x80, 0x01, 0x00]).record(&mut tell).unwrap();
        assert_eq!(found, [(1, 1), (2, -2), (5, 64)]);
    }

    #[test]
    fn records_without_end() {
        let deep = vec![0x1c; 100_000];
        assert!(Thrift::new(&deep).record(&mut |_, _| Some(())).is_none());
    }

    #[test]
    fn lengths_beyond_the_bytes() {
        for bytes in [&[0x18, 0xff, 0xff, 0xff, 0x7f][..], &[0x19, 0xf5, 0xff, 0xff, 0xff, 0x7f], &[0x1b, 0x7f, 0x55]] {
            assert!(Thrift::new(bytes).record(&mut |_, _| Some(())).is_none(), "{bytes:?}");
        }
    }
}
