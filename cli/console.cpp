#include "cli/console.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace burnish {

namespace {

bool is_dumb() {
    const char* terminal = std::getenv("TERM");
    return terminal && std::string_view(terminal) == "dumb";
}

/// https://no-color.org
bool has_colors() {
    const char* none = std::getenv("NO_COLOR");
    return !(none && *none) && !is_dumb();
}

std::shared_ptr<spdlog::logger> make_logger(const char* name, const char* pattern) {
    auto logger = spdlog::stderr_color_mt(
        name, has_colors() ? spdlog::color_mode::automatic : spdlog::color_mode::never);
    logger->set_pattern(pattern);
    return logger;
}

/// Of the process, as standard error is.
struct Speech {
    bool quiet = false;
    std::string error;
};
Speech& speech() {
    static Speech only;
    return only;
}

}  // namespace

void be_quiet() { speech().quiet = true; }
std::string last_error() { return speech().error; }

void log_info(const std::string& text) {
    if (speech().quiet) return;
    static const auto logger = make_logger("say", "%v");
    logger->info(printable(text));
}

void log_warning(const std::string& text) {
    if (speech().quiet) return;
    static const auto logger = make_logger("warn", "burnish: %^warning%$: %v");
    logger->warn(printable(text));
}

void report_error(const std::string& text) {
    speech().error = printable(text);
    if (speech().quiet) return;
    static const auto logger = make_logger("error", "burnish: %v");
    logger->error(printable(text));
}

std::string printable(const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0u;
        if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7f)
            result += fmt::format("\\x{:02x}", c);
        else if (c == 0xc2 && next >= 0x80 && next < 0xa0)  // the control characters of Latin-1
            result += fmt::format("\\x{:02x}", next), ++i;
        else
            result += text[i];
    }
    return result;
}

bool can_rewrite_lines() { return !speech().quiet && isatty(STDERR_FILENO) != 0 && !is_dumb(); }

std::string one_line(const std::string& text) {
    std::string line;
    for (const char c : text) {
        const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
        if (!space)
            line += c;
        else if (!line.empty() && line.back() != ' ')
            line += ' ';
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    return line;
}

std::string shell_word(const std::string& name) {
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) ||
               static_cast<unsigned char>(c) >= 0x80 ||
               std::string_view("_-./:,+@%=").find(c) != std::string_view::npos;
    };
    if (!name.empty() && std::all_of(name.begin(), name.end(), plain)) return name;
    std::string word = "'";
    for (const char c : name) word += c == '\'' ? "'\\''" : std::string(1, c);
    return word + "'";
}

std::string duration_text(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<long long>(seconds + 0.5);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string short_duration_text(double seconds) {
    if (seconds < 0.00995) return fmt::format("{:.2g} ms", 1000 * seconds);
    if (seconds < 0.995) return fmt::format("{:.2g} s", seconds);
    return duration_text(seconds);
}

std::string digits_text(double number) {
    constexpr double kMaxDigits = 1e15;
    if (!(number >= 999.5 && number < kMaxDigits)) return fmt::format("{:.3g}", number);
    return count_text(static_cast<std::size_t>(number + 0.5));
}

std::string significant_text(double number, int digits) {
    if (number == 0 || !std::isfinite(number)) return fmt::format("{:g}", number);
    const std::string scientific = fmt::format("{:.{}e}", number, digits - 1);
    const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
    if (exponent < -4 || exponent >= digits) return scientific;
    return fmt::format("{:.{}f}", number, digits - 1 - exponent);
}

std::string percent_text(double share) {
    const double percent = 100 * share;
    if (percent < 0.01) return "less than 0.01 %";
    return percent < 10 ? fmt::format("{:.2g} %", percent) : fmt::format("{:.0f} %", percent);
}

std::string bytes_text(double bytes) {
    constexpr const char* kUnits[] = {"KiB", "MiB", "GiB", "TiB"};
    if (bytes < 1024) return fmt::format("{:.0f} B", bytes);
    std::size_t unit = 0;
    for (bytes /= 1024; bytes >= 1024 && unit + 1 < std::size(kUnits); bytes /= 1024) ++unit;
    return fmt::format("{:.1f} {}", bytes, kUnits[unit]);
}

std::string count_text(std::size_t count) {
    std::string text = std::to_string(count);
    for (std::size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, 1, ' ');
    return text;
}

std::string count_text(std::size_t count, const std::string& one, const std::string& more) {
    const std::string plural = more.empty() ? one + "s" : more;
    return count_text(count) + " " + (count == 1 ? one : plural);
}

}  // namespace burnish
