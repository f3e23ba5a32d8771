#include "cli/live_view.h"

#include <utility>

#include "cli/console.h"
#include "optimize/ranks.h"

namespace burnish {

LiveView::LiveView(const RunResult& run, const OutputFolder& output, const std::string& part) {
    if (run.settings.run.live.empty() || !is_first(run.ranks)) return;
    const std::string title = output.folder.filename().string();
    live_.emplace(run.settings.run.live, part.empty() ? title : title + "/" + part,
                  [note = note_](const std::string& text) {
                      const std::lock_guard lock(note->mutex);
                      note->text = text;
                  });
}

void LiveView::update(const Solver& solver) {
    if (!live_) return;
    live_->update(solver);
    warn();
}

void LiveView::finish(const Problem& problem, const Summary& summary) {
    if (!live_) return;
    live_->show(problem, summary);
    live_.reset();
    warn();
}

void LiveView::warn() {
    const std::lock_guard lock(note_->mutex);
    if (!note_->text.empty()) log_warning("--live: " + std::exchange(note_->text, {}));
}

}  // namespace burnish
