// Settings as JSON: option files, and what a summary records.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "cli/settings.h"

namespace burnish {

/// Reads {"path_cache": {"window": 8}, "stop.iterations": 100, ...}, or the `settings` of a
/// summary.json. Throws InputError that names the file: it is no such JSON, holds an option that
/// there is not, or a value that does not fit.
std::vector<Given> read_options_file(const std::string& file);

/// The same from a text; name: in messages.
std::vector<Given> read_options_text(const std::string& text, const std::string& name);

/// As read_options_file reads them.
nlohmann::ordered_json settings_json(const Settings& settings);

/// Throws InputError where a text of the settings is not UTF-8: JSON would hold another one, and a
/// run could not go on from its record.
void require_recordable(const Settings& settings);

}  // namespace burnish
