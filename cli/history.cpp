#include "cli/history.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

namespace burnish {

std::string history_row(const Iteration& i) {
    return fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f},{:.9g},{},{},{},{},{},{}\n", i.number,
                       i.seconds, i.image_seconds, i.derivative_seconds, i.step_seconds, i.loss,
                       i.paths, i.derivatives, i.texels, i.reservoirs,
                       i.rejected_image + i.rejected_derivatives,
                       i.held_out_loss ? fmt::format("{:.9g}", *i.held_out_loss) : "");
}

std::string history_csv(const std::vector<Iteration>& iterations) {
    std::string csv(kHistoryStart);
    csv +=
        "image_seconds,derivative_seconds,step_seconds,loss,paths,derivatives,texels,reservoirs,"
        "rejected,held_out_loss\n";
    for (const Iteration& i : iterations) csv += history_row(i);
    return csv;
}

bool is_history(const std::filesystem::path& file) {
    std::error_code ignored;
    if (file.filename() != kHistory ||
        !std::filesystem::is_regular_file(std::filesystem::symlink_status(file, ignored)))
        return false;
    std::ifstream stream(file, std::ios::binary);
    std::string start(kHistoryStart.size(), '\0');
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    return stream.is_open() && kHistoryStart.starts_with(start);
}

}  // namespace burnish
