#![no_main]

use topout_schedule_fuzz::{fixtures, survives, write_seeds};

libfuzzer_sys::fuzz_target!(
    init: write_seeds("pmxml", &[fixtures::PMXML]),
    |bytes: &[u8]| survives("p6.xml", bytes)
);
