#include "cli/console.h"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>

namespace burnish {

namespace {

std::shared_ptr<spdlog::logger> make_logger(const char* name, const char* pattern) {
    auto logger = spdlog::stderr_color_mt(name);
    logger->set_pattern(pattern);
    return logger;
}

}  // namespace

void log_info(const std::string& text) {
    static const auto logger = make_logger("say", "%v");
    logger->info(text);
}

void log_warning(const std::string& text) {
    static const auto logger = make_logger("warn", "burnish: %^warning%$: %v");
    logger->warn(text);
}

void report_error(const std::string& text) {
    static const auto logger = make_logger("error", "burnish: %v");
    logger->error(text);
}

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

std::string duration_text(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<long long>(seconds + 0.5);
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
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

}  // namespace burnish
