// Cameras against COLMAP's own projections of points.
#include "captures/camera_model.h"

#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "csv.h"
#include "shading/camera.h"
#include "worst.h"

namespace burnish {
namespace {

const std::string kTable = BURNISH_TEST_DATA "/cameras/lenses.csv";

Camera camera_of(const test::CsvRow& row) {
    const CameraModel* model = find_camera_model(static_cast<int>(row["model"]));
    if (!model) throw std::runtime_error("no such model");
    EXPECT_EQ(static_cast<double>(parameter_count(*model)), row["count"]) << model->name;
    std::vector<double> parameters;
    for (std::size_t i = 0; i < parameter_count(*model); ++i)
        parameters.push_back(row["p" + std::to_string(i)]);
    return make_camera(*model, static_cast<int>(row["width"]), static_cast<int>(row["height"]),
                       parameters);
}

std::vector<std::string> model_names() {
    std::vector<std::string> names;
    std::istringstream list(camera_model_names());
    for (std::string name; std::getline(list >> std::ws, name, ',');) names.push_back(name);
    return names;
}

struct Pixel {
    double x = 0, y = 0;
};

Pixel project(const Camera& camera, const Vec3<double>& point) {
    const Vec2<double> u = distort(camera.lens, point);
    return {camera.focal_x * u.x + camera.center_x, camera.focal_y * u.y + camera.center_y};
}

/// The largest distances, in pixels, over the table: of points that are projected, and of the rays
/// through COLMAP's pixels.
struct Worst {
    double projected = 0, ray = 0;
};

Worst worst_of(const test::CsvRow& row, const Camera& camera) {
    const Vec3<double> point{row["x"], row["y"], row["z"]};
    const Pixel p = project(camera, point);
    const auto film = [&](double pixel, int size) { return static_cast<float>(pixel / size); };
    const auto ray =
        camera_ray<float>(make_camera_rays(camera, 0.01f, 100),
                          Vec2f{film(row["u"], camera.width), film(row["v"], camera.height)});
    EXPECT_GT(ray.max_distance, 0) << "line " << row.line;
    // Where the ray is as far from the eye as the point, seen by the camera.
    const Pixel q = project(
        camera, {double{ray.direction.x}, double{ray.direction.y}, double{ray.direction.z}});
    return {std::hypot(p.x - row["u"], p.y - row["v"]), std::hypot(q.x - p.x, q.y - p.y)};
}

TEST(CameraModels, ProjectAsColmapDoes) {
    std::set<int> models;
    Worst worst;
    for (const test::CsvRow& row : test::read_csv(kTable)) {
        models.insert(static_cast<int>(row["model"]));
        const Worst w = worst_of(row, camera_of(row));
        EXPECT_LT(w.projected, 1e-6) << "line " << row.line;
        EXPECT_LT(w.ray, 1e-3) << "line " << row.line;
        worst = {test::worse(worst.projected, w.projected), test::worse(worst.ray, w.ray)};
    }
    EXPECT_EQ(models.size(), model_names().size()) << "each model is in the table";
    RecordProperty("projected", std::to_string(worst.projected));
    RecordProperty("ray", std::to_string(worst.ray));
}

/// Tangential coefficients that change places are noticed.
TEST(CameraModels, AWrongCoefficientIsNoticed) {
    std::size_t rows = 0;
    for (const test::CsvRow& row : test::read_csv(kTable)) {
        Camera camera = camera_of(row);
        auto& c = camera.lens.coefficients;
        const bool is_aside = std::hypot(row["x"], row["y"]) > 0.3 * row["z"];
        if (camera.lens.kind != LensKind::kBrownConrady || c[2] == c[3] || !is_aside) continue;
        std::swap(c[2], c[3]);
        const Pixel p = project(camera, {row["x"], row["y"], row["z"]});
        EXPECT_GT(std::hypot(p.x - row["u"], p.y - row["v"]), 0.1) << "line " << row.line;
        ++rows;
    }
    EXPECT_GT(rows, 30u);
}

TEST(CameraModels, AreFoundByTheirNames) {
    EXPECT_GT(model_names().size(), 1u);
    for (const std::string& name : model_names()) {
        const CameraModel* model = find_camera_model(name);
        ASSERT_NE(model, nullptr) << name;
        EXPECT_EQ(model->name, name);
        EXPECT_EQ(find_camera_model(model->id), model);
    }
    EXPECT_EQ(find_camera_model("FOV"), nullptr);
    EXPECT_EQ(find_camera_model(7), nullptr);
    EXPECT_EQ(camera_model_name(7), "FOV");
    EXPECT_EQ(camera_model_name(99), "99");
}

}  // namespace
}  // namespace burnish
