//! ArgBlocks: where a field stands in each edition, and what is no field of it.

use fsct_protocol::Edition::{Iec2022, V1_1};
use fsct_protocol::smi::{self, ArgBlock, FS_PORT_CONFIG_LIST};

#[test]
fn identifiers_and_lengths_by_edition() {
    let list = &FS_PORT_CONFIG_LIST;
    assert_eq!((list.id(V1_1), list.id(Iec2022)), (Some(0x8001), Some(0x8100)));
    assert_eq!((list.length(V1_1), list.length(Iec2022)), (48, 50));
    for edition in [V1_1, Iec2022] {
        for block in smi::ALL {
            if let Some(id) = block.id(edition) {
                assert_eq!(ArgBlock::of_id(edition, id), Some(block));
            }
            let end = |field: &smi::Field| field.offset(edition).map_or(0, |at| at + usize::from(field.octets));
            let length = block.length(edition);
            assert!(length == 0 || block.fields.iter().all(|field| end(field) <= length), "{}", block.name);
        }
    }
    assert_eq!(ArgBlock::of_id(V1_1, 0x1234), None);
}

#[test]
fn a_field_is_read_where_it_was_put() {
    let field = FS_PORT_CONFIG_LIST.field("FSP_Authenticity1").expect("it has one");
    assert_eq!((field.offset(V1_1), field.offset(Iec2022)), (Some(14), Some(16)));
    let mut block = [0; 50];
    field.put(Iec2022, &mut block, 0x1122_3344);
    assert_eq!(block[16..20], [0x11, 0x22, 0x33, 0x44]);
    assert_eq!(block.iter().filter(|octet| **octet != 0).count(), 4);
    assert_eq!(field.value(Iec2022, &block), Some(0x1122_3344));
    assert_eq!(field.value(V1_1, &block), Some(0x1122), "two octets earlier");
}

#[test]
fn what_is_not_there_is_neither_read_nor_put() {
    let list = &FS_PORT_CONFIG_LIST;
    assert_eq!(list.field("FSP_Colour"), None);
    let field = list.field("FSP_TimeToReady").expect("iec2022 has it");
    let mut block = [0; 50];
    field.put(V1_1, &mut block, 7);
    field.put(Iec2022, &mut block[..13], 7);
    assert_eq!(block, [0; 50]);
    assert_eq!((field.value(V1_1, &block), field.value(Iec2022, &block[..13])), (None, None));
}
