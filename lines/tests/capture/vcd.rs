//! Value change dumps.

use super::tools::{levels, opened, refused, told};
use fsct_lines::Recording;
use fsct_lines::capture::Format;
use rstest::rstest;

/// A dump of L+, C/Q and I/Q as libsigrok writes it, with this time scale, comment and body.
fn dump(scale: &str, comment: &str, body: &str) -> String {
    format!(
        "$date today $end\n$version libsigrok 0.5.2 $end\n$comment\n  {comment}\n$end\n$timescale {scale} $end\n\
         $scope module libsigrok $end\n$var wire 1 ! L+ $end\n$var wire 1 \" C/Q $end\n$var wire 1 # I/Q $end\n\
         $upscope $end\n$enddefinitions $end\n{body}"
    )
}

#[test]
fn edges_of_a_tick_come_in_the_order_of_the_file() {
    let text = dump("1 us", "Acquisition with 3/8 channels at 1 MHz", "#0 1! 0\" 0#\n#4 1\" 0!\n#9 1#\n#12\n");
    let mut capture = opened(text.as_bytes(), "", "").unwrap();
    assert_eq!(capture.format(), Format::Vcd);
    assert_eq!(capture.levels(), levels(true, false, false));
    assert_eq!(told(&mut capture), "c1@4000 p0@4000 i1@9000");
    assert_eq!(capture.end(), 12_000);
    assert_eq!(
        capture.stated(),
        "VCD, sampled at 1 MHz as the file states, times in steps of 1 us: an edge may be off by 1000 ns; \
         L+ is `libsigrok.L+`; C/Q is `libsigrok.C/Q`; I/Q is `libsigrok.I/Q`"
    );
}

#[rstest]
#[case::the_tick("1 us", "", "", 1_000)]
#[case::a_fine_tick("100ps", "", "", 1)]
#[case::the_sample_period("100 ps", "Acquisition with 2/13 channels at 24 MHz", "", 42)]
#[case::the_period_of_the_user("1 ns", "", "24 MHz", 43)]
#[case::a_tick_that_the_period_meets("10 ns", "", "25 MHz", 40)]
#[case::as_our_writer_states_it("1 ns", "edges may be off by at most 77 ns", "", 77)]
#[case::another_comment("1 ns", "Acquisition with care", "", 1)]
fn uncertainty(#[case] scale: &str, #[case] comment: &str, #[case] rate: &str, #[case] expected: u64) {
    let text = dump(scale, comment, "#0 1! 0\" 0#\n");
    assert_eq!(opened(text.as_bytes(), "", rate).unwrap().uncertainty_ns(), expected);
}

#[test]
fn a_rate_that_is_not_stated_is_said_to_be_missing() {
    let stated = opened(dump("1 ns", "", "#0 1! 0\" 0#\n").as_bytes(), "", "").unwrap().stated();
    let expected = "VCD, no sample rate stated, times in steps of 1 ns: an edge may be off by 1 ns, or by the sample period \
                    if that is longer;";
    assert!(stated.starts_with(expected), "{stated}");
}

#[rstest]
#[case::values_before_a_time("$dumpvars 1! 0\" 0# $end\n#0\n#7 1\"\n", "c1@7", 7)]
#[case::edges_behind_the_first_values("#0 $dumpvars 1! 0\" 0# $end\n1\"\n#7 0\"\n", "c1@0 c0@7", 7)]
#[case::the_latest_value_of_the_first_tick("#0 1! 1\" 0# 0\"\n#7 1\"\n", "c1@7", 7)]
#[case::unknown_levels_are_waited_out("#0 x! z\" 0#\n#100 1!\n#200 0\"\n#207 1\"\n", "c1@7", 7)]
#[case::a_late_beginning("#200 1! 0\" 0#\n#207 1\"\n", "c1@7", 7)]
#[case::a_vector_of_one_bit("#0 1! b0 \" 0#\n#7 b1 \"\n", "c1@7", 7)]
#[case::what_does_not_change("#0 1! 0\" 0#\n#5 0\"\n#7 1\"\n#9 1\"\n", "c1@7", 9)]
#[case::a_pulse_without_a_width("#0 1! 0\" 0#\n#5 1\" 0\"\n", "c1@5 c0@5", 5)]
#[case::channels_of_no_line("#0 1! 0\" 0# 1% xA\n#5 0% b101 B r1.5 C\n#7 1\"\n", "c1@7", 7)]
#[case::a_comment("#0 1! 0\" 0#\n$comment 1\" $end\n#7 1\"\n", "c1@7", 7)]
fn bodies(#[case] body: &str, #[case] expected: &str, #[case] end: u64) {
    let mut capture = opened(dump("1 ns", "", body).as_bytes(), "", "").unwrap();
    assert_eq!(capture.levels(), levels(true, false, false));
    assert_eq!(told(&mut capture), expected);
    assert_eq!(capture.end(), end);
}

#[test]
fn the_time_of_the_file_at_time_0_is_told() {
    let text = dump("1 us", "", "#0 x! 0\" 0#\n#250 1!\n#251 1\"\n");
    let stated = opened(text.as_bytes(), "", "").unwrap().stated();
    assert!(stated.ends_with("; time 0 is 0.00025 s of the file"), "{stated}");
}

#[test]
fn times_are_divided_anew_each_time() {
    let body = "#0 1! 0\" 0#\n#1500 1\"\n#2500 0\"\n#3000000000000001999 1\"\n";
    let mut capture = opened(dump("1 ps", "", body).as_bytes(), "", "").unwrap();
    assert_eq!(told(&mut capture), "c1@1 c0@2 c1@3000000000000001");
}

/// A header with these variables in two scopes.
fn scopes(first: &str, second: &str) -> String {
    format!(
        "$timescale 1 ns $end $scope module a $end {first} $scope module b $end {second} $upscope $end $upscope $end \
         $enddefinitions $end\n#0 1! 0\" b101 #\n#7 0! 1\"\n"
    )
}

#[rstest]
#[case::by_default("$var wire 1 ! CQ $end", "$var wire 1 \" DATA $end", "", "c0@7")]
#[case::by_name("$var wire 1 ! X $end", "$var reg 1 \" Y $end", "C/Q=Y,L+=X", "p0@7 c1@7")]
#[case::by_scope("$var wire 1 ! CQ $end", "$var wire 1 \" CQ $end", "C/Q=a.b.CQ", "c1@7")]
#[case::in_the_outer_scope("$var wire 1 ! CQ $end", "$var wire 1 \" CQ $end", "C/Q=a.CQ", "c0@7")]
#[case::in_other_capitals("$var wire 1 ! Data $end", "$var wire 1 \" Y $end", "cq=dATA", "c0@7")]
#[case::capitals_tell_apart("$var wire 1 ! d $end", "$var wire 1 \" D $end", "C/Q=D", "c1@7")]
#[case::by_number("$var wire 1 ! D4 $end", "$var wire 1 \" D5 $end", "I/Q = 5", "i1@7")]
#[case::a_bit_of_a_vector("$var wire 1 ! D [0] $end", "$var wire 1 \" D [1] $end", "C/Q=D[1]", "c1@7")]
fn mappings(#[case] first: &str, #[case] second: &str, #[case] channels: &str, #[case] expected: &str) {
    let mut capture = opened(scopes(first, second).as_bytes(), channels, "").unwrap();
    assert_eq!(told(&mut capture), expected);
}

const X: &str = "$var wire 1 ! X $end";

#[rstest]
#[case::none_by_name(
    X,
    "$var wire 1 \" Y $end",
    "",
    "no channel is called L+, C/Q or I/Q, so tell which they are, such as C/Q=D1: there are `a.X`, `a.b.Y`"
)]
#[case::unknown(X, "$var wire 1 \" Y $end", "C/Q=D1", "there is no channel `D1` to be C/Q: there are `a.X`, `a.b.Y`")]
#[case::no_channel("", "", "C/Q=D1", "there is no channel `D1` to be C/Q: there is none")]
#[case::either(
    "$var wire 1 ! CQ $end",
    "$var wire 1 \" cq $end",
    "",
    "more than one channel may be C/Q, so tell which it is: there are `a.CQ`, `a.b.cq`"
)]
#[case::twice(X, "", "C/Q=X,I/Q=X", "`a.X` cannot be both C/Q and I/Q")]
#[case::a_vector(X, "$var wire 3 # CQ $end", "", "`a.b.CQ` is no single wire: export it bit by bit")]
#[case::a_real(X, "$var real 1 # CQ $end", "", "`a.b.CQ` is no single wire: export it bit by bit")]
#[case::no_line(X, "", "D=X", "`D` is no line: there are L+, C/Q and I/Q")]
#[case::no_mapping(X, "", "X", "`X` is no line and channel, such as C/Q=D1")]
#[case::a_mapping_of_nothing(X, "", "C/Q=", "no channel is told for C/Q")]
#[case::two_mappings(X, "", "C/Q=X,CQ=Y", "CQ is told twice")]
fn mappings_refused(#[case] first: &str, #[case] second: &str, #[case] channels: &str, #[case] expected: &str) {
    assert_eq!(refused(scopes(first, second).as_bytes(), channels), expected);
}

#[test]
fn of_many_channels_an_error_lists_some() {
    let many: String = (0..1_000).map(|number| format!("$var wire 1 ! N{number} $end ")).collect();
    let sentence = refused(scopes(&many, "").as_bytes(), "C/Q=D1");
    assert!(sentence.ends_with("`a.N14`, `a.N15` and 984 more"), "{sentence}");
}

#[rstest]
#[case::time_goes_back("#0 1! 0\" 0#\n#5 1\"\n#4 0\"\n", "line 15: time goes back from #5 to #4")]
#[case::unknown_later("#0 1! 0\" 0#\n#5 x\"\n", "line 14: C/Q is neither 0 nor 1 any more at #5")]
#[case::a_vector_later("#0 1! 0\" 0#\n#5 b01 \"\n", "line 14: C/Q is neither 0 nor 1 any more at #5")]
#[case::no_time("", "it has no time stamp behind its header")]
#[case::no_level("#0 1! 0\"\n", "the lines never have levels all at once: I/Q has none")]
#[case::cut_in_a_time("#0 1! 0\" 0#\n#5", "line 14: the file ends in the middle of a command or a line: it is cut off")]
#[case::other_text(
    "#0 1! 0\" 0#\nhello\n",
    "this is no sound VCD: unexpected character at start of command at line 14"
)]
#[case::zeros("#0 1! 0\" 0#\n\0\0\0\0", "this is no sound VCD: unexpected character at start of command at line 14")]
#[case::beyond_nanoseconds(
    "#0 1! 0\" 0#\n#18446744073709551616 1\"\n",
    "this is no sound VCD: number too large to fit in target type at line 14"
)]
fn bodies_refused(#[case] body: &str, #[case] expected: &str) {
    assert_eq!(refused(dump("1 ns", "", body).as_bytes(), ""), expected);
}

#[rstest]
#[case::scale_missing("$enddefinitions $end\n", "its header states no $timescale")]
#[case::scale_0("$timescale 0 ns $end $enddefinitions $end\n", "its header states no $timescale")]
#[case::scale_in_words(
    "$timescale one ns $end\n",
    "this is no sound VCD: cannot parse integer from empty string at line 1"
)]
#[case::cut_off("$timescale 1 ns $end\n", "it ends within its header: it is cut off")]
#[case::cut_off_in_a_comment(
    "$comment 1 ns",
    "line 1: the file ends in the middle of a command or a line: it is cut off"
)]
#[case::a_change("$timescale 1 ns $end\n1!\n", "line 2: a change comes before $enddefinitions")]
#[case::a_scope_that_has_not_begun("$upscope $end\n", "line 1: a scope ends that has not begun")]
#[case::unknown("$hello $end\n", "this is no sound VCD: unknown command at line 1")]
fn headers_refused(#[case] text: &str, #[case] expected: &str) {
    assert_eq!(refused(text.as_bytes(), ""), expected);
}

#[test]
fn a_time_beyond_nanoseconds_is_refused() {
    let text = dump("1 s", "", "#0 1! 0\" 0#\n#18446744073 0\"\n#18446744074 1\"\n");
    assert_eq!(refused(text.as_bytes(), ""), "line 15: the time is too late to be counted in nanoseconds");
}

#[test]
fn a_rate_that_contradicts_the_file_is_refused() {
    let text = dump("1 us", "Acquisition with 3/8 channels at 1 MHz", "#0 1! 0\" 0#\n");
    let error = opened(text.as_bytes(), "", "24 MHz").unwrap_err();
    assert_eq!(error.what, "the file states a sample rate of 1 MHz, not of 24 MHz");
}

const TOO_LONG: &str = "a command, or the whole header, is longer than any logic analyser writes";

#[test]
fn what_has_no_end_is_refused() {
    let long = "a".repeat(1 << 21);
    assert_eq!(refused(format!("$comment {long}").as_bytes(), ""), format!("line 1: {TOO_LONG}"));
    let many = format!("$var wire 1 ! {} $end\n", "b".repeat(1_000)).repeat(2_000);
    assert!(refused(many.as_bytes(), "").ends_with(TOO_LONG));
    let sound = dump("1 ns", "", "#0 1! 0\" 0#\n");
    assert_eq!(refused(format!("{sound}s{long}").as_bytes(), ""), format!("line 14: {TOO_LONG}"));
    assert_eq!(refused(format!("{sound}{}", " ".repeat(1 << 17)).as_bytes(), ""), format!("line 14: {TOO_LONG}"));
    assert_eq!(
        refused("$scope module a $end\n".repeat(40_000).as_bytes(), ""),
        "line 129: its scopes are too deep or too long"
    );
}

#[test]
fn a_mark_of_byte_order_is_passed_over() {
    let text = format!("\u{FEFF}{}", dump("1 ns", "", "#0 1! 0\" 0#\n#7 1\"\n"));
    assert_eq!(told(&mut opened(text.as_bytes(), "", "").unwrap()), "c1@7");
}
