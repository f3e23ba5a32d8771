#include "cli/live_view.h"

#include "cli/console.h"
#include "cli/folder_content.h"
#include "optimize/ranks.h"

namespace burnish {

LiveView::LiveView(const RunResult& run, const OutputFolder& output, const std::string& part)
    : run_(run) {
    if (run.settings.run.live.empty() || !is_first(run.ranks)) return;
    const std::string title = without_slash(output.folder).filename().string();
    live_.emplace(run.settings.run.live, part.empty() ? title : title + "/" + part, note_.hear());
}

void LiveView::update(const Solver& solver) {
    if (!live_) return;
    live_->update(solver);
    warn();
}

void LiveView::finish(const Summary& summary) {
    if (!live_) return;
    for (std::size_t i = 0; i < summary.textures.size(); ++i)
        live_->show(run_.textures[i].name, summary.textures[i].values);
    live_->show(run_.views, summary.result);
    live_.reset();
    warn();
}

void LiveView::warn() {
    const std::string text = note_.take();
    if (!text.empty()) log_warning("--live: " + text);
}

}  // namespace burnish
