#!/usr/bin/env bash
# Fuzzes every target for so many seconds: fuzz/run.sh SECONDS. Stable Rust and a C++ compiler are enough; cargo-fuzz is
# installed when it is absent. What is found beyond fuzz/corpus stays in fuzz/found and is gone with it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:?how many seconds for each target}

command -v cargo-fuzz >/dev/null || cargo install --locked --version 0.13.2 cargo-fuzz
# libFuzzer's instrumentation is no stable option; the compiler is.
export RUSTC_BOOTSTRAP=1
# cargo fuzz knows no --locked.
cargo metadata --locked --format-version 1 --manifest-path fuzz/Cargo.toml >/dev/null
for target in frame_decoder session capture; do
    mkdir -p "fuzz/found/$target"
    cargo fuzz run -s none "$target" "fuzz/found/$target" "fuzz/corpus/$target" -- \
        -max_total_time="$seconds" -len_control=0 -max_len=1024 -timeout=10 -rss_limit_mb=1024 -print_final_stats=1
done
