#include "captures/capture_json.h"

#include "captures/camera_model.h"
#include "core/variant.h"

namespace burnish {

namespace {

using Json = nlohmann::ordered_json;

Json rows_of(const Matrix& matrix) {
    Json rows = Json::array();
    for (std::size_t row = 0; row < 4; ++row)
        rows.push_back(
            {matrix[4 * row], matrix[4 * row + 1], matrix[4 * row + 2], matrix[4 * row + 3]});
    return rows;
}

Json to_json(const ViewCamera& camera) {
    return match(
        camera,
        [](const Sensor& sensor) -> Json {
            return {{"sensor", sensor.name}};
        },
        [](const Camera& c) -> Json {
            const CameraModel& model = general_model(c.lens.kind);
            return {{"model", model.name},
                    {"width", c.width},
                    {"height", c.height},
                    {"params", parameters_of(model, c)},
                    {"camera_to_world", rows_of(c.camera_to_world)}};
        });
}

Json to_json(const CapturedView& captured) {
    Json written{{"name", captured.view.name}};
    if (!captured.image.empty()) written["image"] = captured.image;
    if (!captured.mask.empty()) written["mask"] = captured.mask;
    if (captured.turning == Turning::kAsStored) written["orientation"] = "stored";
    written["camera"] = to_json(captured.view.camera);
    written["split"] = captured.view.held_out ? "test" : "train";
    return written;
}

}  // namespace

Json to_json(const Capture& capture) {
    Json written{{"version", 1}, {"scene", capture.scene}};
    if (!capture.definitions.empty()) written["defines"] = capture.definitions;
    written["views"] = Json::array();
    for (const CapturedView& view : capture.views) written["views"].push_back(to_json(view));
    return written;
}

}  // namespace burnish
