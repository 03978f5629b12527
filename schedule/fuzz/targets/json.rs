#![no_main]

use topout_schedule_fuzz::{fixtures, survives, write_seeds};

libfuzzer_sys::fuzz_target!(
    init: write_seeds("json", &[fixtures::JSON]),
    |bytes: &[u8]| survives("plan.json", bytes)
);
