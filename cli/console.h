// Text for the person at the terminal, on standard error. Standard output carries only what a
// command is asked to print. Colours are left out where NO_COLOR is set or TERM is "dumb".
#pragma once

#include <string>

namespace burnish {

/// Nothing of what follows is said: of several processes that share a terminal one speaks.
void be_quiet();

/// A line of text.
void log_info(const std::string& text);
/// "burnish: warning: ..."; coloured on a terminal.
void log_warning(const std::string& text);
/// "burnish: ..."
void report_error(const std::string& text);
/// What report_error was called with last, said or not.
std::string last_error();

/// What is left of the text on a terminal, whatever it holds: control characters as \x1b.
std::string printable(const std::string& text);

/// Whether the terminal can rewrite a line: standard error is one, and TERM is not "dumb".
bool can_rewrite_lines();

/// Line breaks and what surrounds them become single spaces.
std::string one_line(const std::string& text);

/// A name as a word of a command that is shown: in quotes where a shell would not read it as it is.
std::string shell_word(const std::string& name);

/// "1.2 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double seconds);
/// The same of short ones with two digits: "3.5 ms", "0.12 s".
std::string short_duration_text(double seconds);
/// Three digits, and all before the point: "0.0123", "1 234".
std::string digits_text(double number);
/// So many significant digits, zeros at the end among them: "0.0580", "100"; "0" of 0. With an
/// exponent below 0.0001 and where there are more digits before the point: "1.00e-07".
std::string significant_text(double number, int digits);
/// Of a share above 0, two digits, and all before the point: "0.012 %", "100 %".
std::string percent_text(double share);
/// "412 B", "3.4 MiB", ...
std::string bytes_text(double bytes);
/// 12345678 as "12 345 678".
std::string count_text(std::size_t count);
/// "1 view", "12 345 views", "2 meshes". more: the plural where it is not `one` with an s.
std::string count_text(std::size_t count, const std::string& one, const std::string& more = {});

}  // namespace burnish
