//! An entry of a bag of ROS 1: fields by their names, and data.

/// The fields of a header: each a length, a name, `=` and a value.
pub(super) struct Header<'a>(pub(super) &'a [u8]);

pub(super) struct Entry<'a> {
    pub(super) header: Header<'a>,
    pub(super) data: &'a [u8],
}

impl<'a> Entry<'a> {
    /// The first entry of some bytes, which are then those after it.
    pub(super) fn first(bytes: &mut &'a [u8]) -> Option<Self> {
        let (header, after) = part(bytes)?;
        let (data, after) = part(after)?;
        *bytes = after;
        Some(Self { header: Header(header), data })
    }
}

impl<'a> Header<'a> {
    fn value(&self, name: &str) -> Option<&'a [u8]> {
        let mut rest = self.0;
        while let Some((field, after)) = part(rest) {
            let value = field.strip_prefix(name.as_bytes()).and_then(|value| value.strip_prefix(b"="));
            if value.is_some() {
                return value;
            }
            rest = after;
        }
        None
    }

    /// A field of one byte.
    pub(super) fn number(&self, name: &str) -> Option<u8> {
        self.value(name)?.first().copied()
    }

    /// A field of four bytes.
    pub(super) fn word(&self, name: &str) -> Option<u32> {
        self.value(name)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
    }

    /// A time in nanoseconds: seconds and nanoseconds of four bytes each.
    pub(super) fn time_ns(&self, name: &str) -> Option<i64> {
        let (seconds, nanoseconds) = self.value(name)?.split_first_chunk()?;
        let nanoseconds = u32::from_le_bytes(*nanoseconds.first_chunk()?);
        Some(i64::from(u32::from_le_bytes(*seconds)) * 1_000_000_000 + i64::from(nanoseconds))
    }

    pub(super) fn text(&self, name: &str) -> Option<&'a str> {
        str::from_utf8(self.value(name)?).ok()
    }
}

/// A part with its length in four bytes before it, and what follows.
fn part(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}
