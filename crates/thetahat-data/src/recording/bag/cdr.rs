//! Joint states from the bytes of a message: the common data representation (CDR) of DDS, as ROS 2 writes it.
//!
//! Four bytes state the byte order; after them each number is aligned to its size. Text is its length with the final zero, then the bytes;
//! a sequence is its length, then the elements.
//! Sources: OMG DDSI-RTPS 2.2, section 10.2; `sensor_msgs/msg/JointState.msg`.

/// Largest number of joints that one message may name.
const MOST_JOINTS: usize = 1024;

/// A message of `sensor_msgs/msg/JointState`.
#[derive(Debug, PartialEq)]
pub(super) struct JointState<'a> {
    /// Time of the header in nanoseconds.
    pub(super) stamp_ns: i64,
    pub(super) names: Vec<&'a str>,
    /// Positions, velocities and efforts: one for each joint, or none at all.
    pub(super) fields: [Vec<f64>; 3],
}

/// The joint states in the bytes of a message, or what is wrong with them.
pub(super) fn joint_state(message: &[u8]) -> Result<JointState<'_>, String> {
    let mut reader = Reader::of(message)?;
    let stamp_ns = reader.stamp().ok_or("it ends within its stamp")?;
    reader.text().ok_or("its frame is not text")?;
    let names = reader.names()?;
    let fields = [
        reader.numbers(&names, "positions")?,
        reader.numbers(&names, "velocities")?,
        reader.numbers(&names, "efforts")?,
    ];
    Ok(JointState { stamp_ns, names, fields })
}

struct Reader<'a> {
    /// The bytes after the first four.
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Reader<'a> {
    fn of(message: &'a [u8]) -> Result<Self, String> {
        match message.split_first_chunk() {
            Some(([0, order @ (0 | 1), _, _], body)) => Ok(Self { body, at: 0, little: *order == 1 }),
            Some((found, _)) => Err(format!("expected plain CDR, which begins with 0 0 or 0 1, found {found:?}")),
            None => Err("it is shorter than four bytes".to_owned()),
        }
    }

    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let start = self.at.next_multiple_of(N);
        let mut bytes = *self.body.get(start..)?.first_chunk()?;
        self.at = start + N;
        if !self.little {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn length(&mut self) -> Option<usize> {
        usize::try_from(u32::from_le_bytes(self.bytes()?)).ok()
    }

    fn stamp(&mut self) -> Option<i64> {
        let seconds = i32::from_le_bytes(self.bytes()?);
        let nanoseconds = u32::from_le_bytes(self.bytes()?);
        Some(i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds))
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = self.length()?;
        let bytes = self.body.get(self.at..)?.get(..length)?;
        self.at += length;
        str::from_utf8(bytes.strip_suffix(&[0]).unwrap_or(bytes)).ok()
    }

    fn names(&mut self) -> Result<Vec<&'a str>, String> {
        let count = self.length().ok_or("it ends before its names")?;
        if count > MOST_JOINTS {
            return Err(format!("expected at most {MOST_JOINTS} joints, found {count}"));
        }
        let names: Option<Vec<&str>> = (0..count).map(|_| self.text()).collect();
        let names = names.ok_or("a name of a joint is not text")?;
        match (1..count).find(|&i| names[..i].contains(&names[i])) {
            None => Ok(names),
            Some(i) => Err(format!("joint {:?} is named twice", names[i])),
        }
    }

    fn numbers(&mut self, names: &[&str], what: &str) -> Result<Vec<f64>, String> {
        let count = self.length().ok_or_else(|| format!("it ends before its {what}"))?;
        if count != 0 && count != names.len() {
            return Err(format!("expected {} {what}, one for each joint, found {count}", names.len()));
        }
        let numbers: Option<Vec<f64>> = (0..count).map(|_| self.bytes().map(f64::from_le_bytes)).collect();
        numbers.ok_or_else(|| format!("it ends within its {what}"))
    }
}
