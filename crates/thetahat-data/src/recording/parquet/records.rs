//! The records of Parquet: of a file and of a page.
//!
//! Source: parquet.thrift of Apache Parquet 2.12.

use super::thrift::Kind::{Binary, Bool, Byte, Double, I16, I32, I64, List};
use super::thrift::{Kind, Record};

/// The name of the record of a column or a group of columns, whose field 5 is its number of children.
pub(super) const SCHEMA_ELEMENT: &str = "SchemaElement";
/// The name of the record of a page, whose field 2 is its size when it is decompressed.
pub(super) const PAGE_HEADER: &str = "PageHeader";

/// The description of a file.
pub(super) static FILE: Record = Record {
    name: "FileMetaData",
    fields: &[
        (1, I32),
        (2, List(&Kind::Record(&ELEMENT))),
        (3, I64),
        (4, List(&Kind::Record(&ROW_GROUP))),
        (5, List(&Kind::Record(&KEY_VALUE))),
        (6, Binary),
        (7, List(&Kind::Record(&CHOICE_OF_NOTHING))),
        (8, Kind::Record(&CHOICE_OF_NOTHING)),
        (9, Binary),
    ],
};

/// The header of a page.
pub(super) static PAGE: Record = Record {
    name: PAGE_HEADER,
    fields: &[
        (1, I32),
        (2, I32),
        (3, I32),
        (4, I32),
        (5, Kind::Record(&DATA_PAGE)),
        (6, Kind::Record(&NOTHING)),
        (7, Kind::Record(&DICTIONARY_PAGE)),
        (8, Kind::Record(&DATA_PAGE_V2)),
    ],
};

static DATA_PAGE: Record = Record {
    name: "DataPageHeader",
    fields: &[(1, I32), (2, I32), (3, I32), (4, I32), (5, Kind::Record(&STATISTICS))],
};

static DATA_PAGE_V2: Record = Record {
    name: "DataPageHeaderV2",
    fields: &[(1, I32), (2, I32), (3, I32), (4, I32), (5, I32), (6, I32), (7, Bool), (8, Kind::Record(&STATISTICS))],
};

static DICTIONARY_PAGE: Record = Record { name: "DictionaryPageHeader", fields: &[(1, I32), (2, I32), (3, Bool)] };

static STATISTICS: Record = Record {
    name: "Statistics",
    fields: &[(1, Binary), (2, Binary), (3, I64), (4, I64), (5, Binary), (6, Binary), (7, Bool), (8, Bool), (9, I64)],
};

static ELEMENT: Record = Record {
    name: SCHEMA_ELEMENT,
    fields: &[
        (1, I32),
        (2, I32),
        (3, I32),
        (4, Binary),
        (5, I32),
        (6, I32),
        (7, I32),
        (8, I32),
        (9, I32),
        (10, Kind::Record(&LOGICAL_TYPE)),
    ],
};

static LOGICAL_TYPE: Record = Record {
    name: "LogicalType",
    fields: &[
        (1, Kind::Record(&NOTHING)),
        (2, Kind::Record(&NOTHING)),
        (3, Kind::Record(&NOTHING)),
        (4, Kind::Record(&NOTHING)),
        (5, Kind::Record(&Record { name: "DecimalType", fields: &[(1, I32), (2, I32)] })),
        (6, Kind::Record(&NOTHING)),
        (7, Kind::Record(&TIME_TYPE)),
        (8, Kind::Record(&TIME_TYPE)),
        (10, Kind::Record(&Record { name: "IntType", fields: &[(1, Byte), (2, Bool)] })),
        (11, Kind::Record(&NOTHING)),
        (12, Kind::Record(&NOTHING)),
        (13, Kind::Record(&NOTHING)),
        (14, Kind::Record(&NOTHING)),
        (15, Kind::Record(&NOTHING)),
        (16, Kind::Record(&Record { name: "VariantType", fields: &[(1, Byte)] })),
        (17, Kind::Record(&Record { name: "GeometryType", fields: &[(1, Binary)] })),
        (18, Kind::Record(&Record { name: "GeographyType", fields: &[(1, Binary), (2, I32)] })),
    ],
};

static TIME_TYPE: Record = Record { name: "TimeType", fields: &[(1, Bool), (2, Kind::Record(&CHOICE_OF_NOTHING))] };

static ROW_GROUP: Record = Record {
    name: "RowGroup",
    fields: &[
        (1, List(&Kind::Record(&COLUMN_CHUNK))),
        (2, I64),
        (3, I64),
        (4, List(&Kind::Record(&Record { name: "SortingColumn", fields: &[(1, I32), (2, Bool), (3, Bool)] }))),
        (5, I64),
        (6, I64),
        (7, I16),
    ],
};

static COLUMN_CHUNK: Record = Record {
    name: "ColumnChunk",
    fields: &[
        (1, Binary),
        (2, I64),
        (3, Kind::Record(&COLUMN)),
        (4, I64),
        (5, I32),
        (6, I64),
        (7, I32),
        (8, Kind::Record(&CHOICE_OF_NOTHING)),
        (9, Binary),
    ],
};

static COLUMN: Record = Record {
    name: "ColumnMetaData",
    fields: &[
        (1, I32),
        (2, List(&I32)),
        (3, List(&Binary)),
        (4, I32),
        (5, I64),
        (6, I64),
        (7, I64),
        (8, List(&Kind::Record(&KEY_VALUE))),
        (9, I64),
        (10, I64),
        (11, I64),
        (12, Kind::Record(&STATISTICS)),
        (13, List(&Kind::Record(&Record { name: "PageEncodingStats", fields: &[(1, I32), (2, I32), (3, I32)] }))),
        (14, I64),
        (15, I32),
        (16, Kind::Record(&Record { name: "SizeStatistics", fields: &[(1, I64), (2, List(&I64)), (3, List(&I64))] })),
        (17, Kind::Record(&GEOSPATIAL_STATISTICS)),
    ],
};

static GEOSPATIAL_STATISTICS: Record =
    Record { name: "GeospatialStatistics", fields: &[(1, Kind::Record(&BOUNDING_BOX)), (2, List(&I32))] };

static BOUNDING_BOX: Record = Record {
    name: "BoundingBox",
    fields: &[(1, Double), (2, Double), (3, Double), (4, Double), (5, Double), (6, Double), (7, Double), (8, Double)],
};

static KEY_VALUE: Record = Record { name: "KeyValue", fields: &[(1, Binary), (2, Binary)] };

static NOTHING: Record = Record { name: "nothing", fields: &[] };

/// One of up to three records, each without fields that matter.
static CHOICE_OF_NOTHING: Record = Record {
    name: "choice",
    fields: &[(1, Kind::Record(&NOTHING)), (2, Kind::Record(&NOTHING)), (3, Kind::Record(&NOTHING))],
};
