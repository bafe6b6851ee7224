//! Files for tests that other programs wrote: compressed by zlib, in base 64.

use std::io::Read;

use flate2::read::ZlibDecoder;

/// The bytes of a file.
pub(super) fn bytes(file: &str) -> Vec<u8> {
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => byte - b'A',
        b'a'..=b'z' => byte - b'a' + 26,
        b'0'..=b'9' => byte - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u8> = file.bytes().filter(|byte| *byte != b'=').map(digit).collect();
    let three = |four: &[u8]| {
        let bits =
            (0..4).fold(0_u32, |bits, place| bits << 6 | u32::from(four.get(place).copied().unwrap_or_default()));
        let [_, bytes @ ..] = bits.to_be_bytes();
        bytes.into_iter().take(four.len() - 1)
    };
    let compressed: Vec<u8> = digits.chunks(4).flat_map(three).collect();
    let mut bytes = Vec::new();
    ZlibDecoder::new(compressed.as_slice()).read_to_end(&mut bytes).unwrap();
    bytes
}

/// Written by h5py 3.16.0: `t`, `arm/q`, `arm/tau` in compressed chunks, and records in `rec`. 5990 bytes.
#[cfg(feature = "hdf5")]
pub(super) const HDF5: &str = "\
    eNrtWLFOAjEYbnt33HloAsHAxZDI6GgigxtnAoRJiRrDZCAIccBBhITEQTYxcXDVJ+AR9A30DVjdHB3dkF7/Ai0qgsZg6JeQL/3vv7+94+vXXq\
    8yyfSSvWIjCstCOgqgYXQB5YjY5tfzwBi4BdwmPI69aw7Eg1BfztvfTaVodlcC72ddZ2whhXlEJrWVpZyDdgz4kYh5NeBC9cTjaqko6HNzwn4x\
    Mti9mLeZkjFmAQ3yBux4qcFYArTqorgfxbuQYPSi9DohBDM9s3oabhgsw5FG0Jqp/2FveyeJe0/JXeLGEOf/PbQ7pvg06fDXdfm8jmnzpeu7W4\
    qHBOOnxGd+Kb/XcX6ZX2AcUNah/HJIT2+mmHfKfbNQF+axO2W/o365xpiIfkkk3yQ/9s+2DTsFaUSNGfBL0ve37JgNDJ+vHVtpeBSvCVGeFnAA\
    eBnYcTHy/ZIOV5EOO46IhSIXSNKhxgr6ezsL7NXndSzPyc+O6+VypQQ16DhY/KhUrhRqg3hfx0R78Q+GQn/6dDsXEXS9oDqU14vQmPtisG6HpP\
    cjY0Na34nEuhKvgoKCgoKCgsK/QOOwmG82fb5L37lpmsi+Ji4LGabjRKOOgxYD+HncKRkZ2V1nvNQwZic/hW+OZvKvwoPIx+cguT99i+/XV4Zj";

/// Written by SciPy 1.17.1: cell arrays `q` of vectors and `bad` of a vector and a text, and `t`. 600 bytes.
pub(super) const CELLS: &str = "\
    eNrzdQzxcXRSMNUzUPB1DNFNy8xJVQjISSxJyy/KtVIoyC/OrNBRcC5KTSxJTVHIz7NSCMkoVfDLL1MwMlMwNLUyMbIyNVUwMjAyYyADMHr68g\
    GpE0DMBsQcICGoFCsSnwlMMzIUAmmQeg8k9WxY1DMjmcMJxBJwCz/YQxkOEIrDgTLzBKDmiEBpCbB5G4jyDzNDUmIKTfxjgGQeCxbzGJHMEwCy\
    KkgKV0aGEgx3YLoHALviIvM=";

/// Written by h5py 3.16.0 as MATLAB does: a cell array `q` of vectors, and the numbers of a table `T`. 3336 bytes.
#[cfg(feature = "hdf5")]
pub(super) const CELLS_7_3: &str = "\
    eNrr9HBx4+WS4mIAAQ4OBhYGAQZk8B8KOHhR+TD5BCjNCKU7oPQKJpg4I1hOAiouCDUfXV1IkKsrSPV/NACz5wErhEZ13SgYKcDD1TEAREdA+Q\
    pQ+gQTqjrlotS0YmUGhkIoPwQtfVqQaC+u9OvBDOFnsBKXfi04RtPvaPpFpF9YeupgRVWXCKWT0NKtA5n2Bvv5uzAyMDNwwPINM6q56OkY5q4H\
    3PjNhaXjA1wjI/4YGdggYcYI42tAaCZGlPBkRos3ZjgtARYTVLCHxoUDgwk3g8l/qAJWoChInokJYiAHNCaYGRs4UWMGAngYDKD28ALVcjD4Oo\
    b4ODrFJ+ckFheDxIWBprAhuSMlvzQpJ5WSlIQtXTHB05UGO3HpZQbnaFmACT7Yo2ZzDoeBS28ruAZjeoOmIqhhIlBagmA4MaGFDxNGeEHCQRwc\
    BvjC5QI3thqcmHBhQbIvOTUnB8IKoElKguVDWD4jNh2xoYULGzx8BMBiIF+zILW8cIfTBx5y0w8rkv0lidDkw+BBlxwIAP1ocbg=";

/// Written by PyArrow 26.0.1: an episode, number 2, with lists of fixed length. 1343 bytes.
#[cfg(feature = "parquet")]
pub(super) const LEROBOT_FIXED: &str = "\
    eNqVlL2LE0EYxt+dmUzmQoS942bYhRRB4uBJLuTkIhY5TUCstjjEXtZkwcDl47JrtDyscpZiIYdFCuur7bSykPgPWIjFlVdYW/nO5oPkLiFxmR\
    kY3nl+8zwvu3tYfbInmSzKoifTErYAHICE9ejkIQBUcOA8wTmoSJA3pc7jKVtyyTNY36wQXOkds6Yppf1v5ArLRvUX5O3P89ZmOTLj4QnDSuex\
    Aqd9cXDa7x8gYVs6eaxNCamc0XKL0Byg1JbbniSxVGRMxTwo25JqTraRHcksblRZmfOkiFV2GeAr2v2NE6q4r6Ia63msT9V2ObadMqughF4sgA\
    wqs6B1IbF/Nvb/YzjE2OLBxD+76p9ZFiWrUi9SMbzL/VgCh4e1F0HTlwJKxNlsPw+Dbs+PGu1WIYz8KEAo9zAMlJjDjhphJAlIcYs4yeAoaAat\
    yMi4XzOK1Wfj3UbUaAYIb3bQA+5vBJ1G2K4HzxqtevAaVMrNu56GjBRuCbjt3r/uKqZPqJKotHpvqQ+WfqrFjskL5mbA2ATKO5pz97F5vXDOYs\
    eul7EuLT2w1qbNpEIGVy3V03+I/kyuE7irgY/VbKye70FMqKsj/Yvqc7qcoP5SxbVQ7xj8b8eEemOpt5b+yfQZW5CSsTilWK9nE9pFQn9KrE2b\
    7xkbJeb6nC9OzFb1bET4ntRnyeUENaTKZFaXFG5nO373+GUQ7dY6nV2/222/yvaCbogJs3fvFYqFPdfDr2Y6YJ8CHOKv8x8Fis9K";

/// Written by PyArrow 26.0.1: episodes 0 and 1, with lists. 1351 bytes.
#[cfg(feature = "parquet")]
pub(super) const LEROBOT_LISTS: &str = "\
    eNqVlL1v00AYh1/fXS7XKEhu1TvZUoYIhRNFaZSiBjGkkEiIyUOF2JFJLBEpX41NYGComNLODAwMEWMHJgYmYGIK/wATAxOqKgb+AF6ndpRPNV\
    i+s053z+P398rJYfXRnmSyKIuOTEvYArAAEsaD4/sAUMEbxzGOYUWCvC51Hk+Zkkuewf3NCsGZ3grnNKV08I3MuUykv6Bvf9a3tsuSGQdPhK50\
    HnfgZCAOTgaDAzRsSyuPexNDKhey3CA0B4hmZc7BR4iaZYguI3oiviXVDL6RvcQNymJaTOivWPZPHFDFdRVp3M/j/oQ2y+PyU+EsKKG/YFEyrE\
    yL1pWYcjvOITLfRyOML+7F9bP5+hnWT2KKRNR86mUUw3fZ70pgcb/2zGu5UkCJWJudp77X67tBo9Mu+IEbeCjlTtjPErNYs+EHkoAUN4iV9Jpe\
    y2sHIcbdWkhcfXa82ggaLQ/lrS7WgOtrXrfhd+rek0a77r0ElbLztqMhI4VdAm7adxerGttjqyQqrd4Y6q2hH2uxE+aF8M2AsQmUdzTn9sPwM8\
    MxrY2qXuU6N/TQWNs2lQodXLVVX/8h+hNZNHBbA49oFtGzPRgbAvVKX1D9ga42qFOmuBbqPYP/7ZhQrw11aujfTJ+xJSkZG6cU6/Ustv1N6I+J\
    tW2zPWOqrpr6guvPfHlidlXPLg0/kvosudqgRlSFmdU5hZvZrts7eu4Fu7Vud9ft9Tovsn2v52PC7O07hWJhz3bwVzO5YZ8CHOJf6D8zLc/0";
