//! Soft links in groups of HDF5's older format, which h5py writes by default. They have no address, for which the library takes the
//! whole file as damaged: they are taken out, since what they lead to has a name of its own.

/// The beginning of a node of a group's symbol table.
const NODE: &[u8] = b"SNOD\x01\0";
/// Bytes of a node before its entries, and of an entry with addresses of 8 bytes.
const HEAD: usize = 8;
const ENTRY: usize = 40;
/// The address of no object, and the kind of an entry that is a soft link.
const NO_ADDRESS: [u8; 8] = [0xff; 8];
const SOFT_LINK: [u8; 4] = [2, 0, 0, 0];

/// Takes the soft links out of all nodes.
pub(super) fn take_out(bytes: &mut [u8]) {
    let nodes: Vec<usize> = memchr::memmem::find_iter(bytes, NODE).collect();
    nodes.into_iter().for_each(|start| take_out_of_node(&mut bytes[start..]));
}

fn take_out_of_node(node: &mut [u8]) {
    let Some(&[low, high]) = node.get(HEAD - 2..HEAD) else { return };
    let count = usize::from(u16::from_le_bytes([low, high]));
    let Some(entries) = node.get_mut(HEAD..HEAD + ENTRY * count) else { return };
    let mut kept = 0_u16;
    for start in (0..count).map(|k| ENTRY * k) {
        if !is_soft_link(&entries[start..start + ENTRY]) {
            entries.copy_within(start..start + ENTRY, ENTRY * usize::from(kept));
            kept += 1;
        }
    }
    node[HEAD - 2..HEAD].copy_from_slice(&kept.to_le_bytes());
}

/// An entry is a place of its name, an address, its kind, and 20 bytes more.
fn is_soft_link(entry: &[u8]) -> bool {
    entry[8..16] == NO_ADDRESS && entry[16..20] == SOFT_LINK
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: u8, address: [u8; 8], kind: u8) -> Vec<u8> {
        [&[name, 0, 0, 0, 0, 0, 0, 0][..], &address, &[kind, 0, 0, 0], &[name; 20]].concat()
    }

    fn node(entries: &[Vec<u8>]) -> Vec<u8> {
        [NODE, &(entries.len() as u16).to_le_bytes(), &entries.concat()].concat()
    }

    #[test]
    fn links_go_and_the_other_entries_close_up() {
        let [a, link, b] = [entry(1, [7; 8], 0), entry(2, NO_ADDRESS, 2), entry(3, [8; 8], 1)];
        let mut found = node(&[a.clone(), link.clone(), b.clone()]);
        take_out(&mut found);
        let mut expected = node(&[a.clone(), b.clone(), b.clone()]);
        expected[HEAD - 2] = 2;
        assert_eq!(found, expected);
        let whole = node(&[a, b]);
        let mut same = whole.clone();
        take_out(&mut same);
        assert_eq!(same, whole);
        let mut cut = node(&[link])[..30].to_vec();
        let before = cut.clone();
        take_out(&mut cut);
        assert_eq!(cut, before);
    }
}
