// What a run of `burnish optimize` is asked for: the scene and the problem beside burnish::Options.
// One table describes the former, optimize/option_table.h the latter; both are given as text by the
// command line and by option files, and come together here.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "burnish/solve.h"
#include "optimize/option_table.h"

namespace burnish {

struct RunSettings {
    std::string scene;  ///< file, XML or capture.json; empty: the built-in goblet
    std::vector<std::string> definitions;  ///< "NAME=VALUE"
    std::vector<int> size;                 ///< width and height, or empty: the scene's
    LightSelection light_selection = SceneSettings{}.light_selection;
    bool ignore_unsupported = false;      ///< of the scene: goes on without it
    std::vector<std::string> parameters;  ///< NAME or NAME@RATE
    std::vector<double> learning_rates;   ///< once, or once per parameter; empty: the default
    std::vector<std::string> starts;      ///< "search", number, file or "scene"; once or for each
    std::vector<std::string> sensors;     ///< of the scene file; empty: the first
    /// Image files: one, or one for each sensor; empty: rendered from the scene's textures.
    std::vector<std::string> targets;
    std::string views;   ///< transforms.json, or folder of a COLMAP reconstruction; empty: none
    std::string images;  ///< folder of the pictures of `views`; empty: that of transforms.json
    std::uint32_t target_samples = 512;
    std::string mask;
    bool ignore_background = false;     ///< pixels without a surface of the scene do not count
    std::vector<std::string> held_out;  ///< names of views that are not fitted
    std::string exposure = "1";         ///< "fit", "fit_rgb" or a number
    double scale = 1;                   ///< of pictures, in (0, 1]
    std::optional<Estimator> compare;
    std::uint32_t compare_iterations = 0;  ///< 0: as long as the first run
    std::optional<double> max_memory;      ///< GiB, of the process; empty: see run_table.cpp
    int threads = 0;                       ///< 0: all cores
    std::string output = "burnish-out";
    bool force = false;
    double checkpoint_seconds = 60;  ///< between two checkpoints
    std::string live;                ///< address of a viewer; empty: none

    friend bool operator==(const RunSettings&, const RunSettings&) = default;
};

/// What RunSettings::exposure says: of all views that do not come from a capture. None: neither
/// "fit" nor "fit_rgb" nor a number above 0 that single precision holds.
std::optional<Exposure> parse_exposure(const std::string& text);

template <class T>
using RunField = T RunSettings::*;

struct RunRow {
    OptionInfo info;
    std::variant<RunField<std::string>, RunField<std::vector<std::string>>,
                 RunField<std::vector<int>>, RunField<std::vector<double>>, RunField<std::uint32_t>,
                 RunField<int>, RunField<double>, RunField<bool>, RunField<LightSelection>,
                 RunField<std::optional<double>>, RunField<std::optional<Estimator>>>
        field;
    const char* needs = "";  ///< where it has an effect in some runs only
    bool (*holds)(const RunSettings&) = nullptr;
    bool recorded = true;    ///< part of what repeats a run
    const char* alone = "";  ///< what the flag means without a value; empty: it must have one
};
std::span<const RunRow> run_table();

/// Whether a parameter has no learning rate of its own, NAME@RATE.
bool has_unrated(const RunSettings& settings);

/// A row of either table, as the command line and the reference page see it.
struct Setting {
    OptionInfo info;
    std::string placeholder, expected, default_value, needs;
    bool is_list = false;    ///< may be given several times
    bool is_pair = false;    ///< two values at a time
    bool is_flag = false;    ///< alone it means "true"
    const char* alone = "";  ///< RunRow::alone
};
/// Those of the run first.
const std::vector<Setting>& all_settings();
/// Throws InputError where there is no setting of the name.
const Setting& find_setting(const std::string& name);
/// What is wrong with a text for a setting, "expected ..., found '...'"; empty where nothing is.
/// Throws InputError where there is no setting of the name.
std::string complaint(const std::string& name, const std::string& text);

/// One option as it was given. The last one counts.
struct Given {
    std::string label;               ///< for messages: "--spp", "--set path_cache.window"
    std::vector<std::string> names;  ///< of rows: those that fit the estimator take the values
    std::vector<std::string> values;
};

struct Settings {
    RunSettings run;
    Options options;
    std::optional<Options> compared;  ///< of the second run, where there is one
};
/// Puts together what was given, later over earlier. Values must have been checked. Throws
/// UsageError: that of a flag fits another estimator alone.
Settings assemble(const std::vector<Given>& given);
/// What the option needs to have an effect; empty where it has one.
std::string missing_for(const Given& given, const Settings& settings);

/// A setting with its values as text.
struct SettingText {
    const OptionInfo* info;
    bool is_list;
    std::vector<std::string> values;
};
/// All that repeats the run: settings that have an effect, defaults included.
std::vector<SettingText> recorded_settings(const Settings& settings);
/// The values of all_settings(), in their order: "none" of those that are not recorded.
std::vector<std::string> setting_texts(const Settings& settings);

}  // namespace burnish
