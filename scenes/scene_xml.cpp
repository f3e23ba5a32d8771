#include "scenes/scene_xml.h"

#include <fmt/format.h>

namespace burnish::procedural {

namespace {

constexpr const char* kHead =
    R"(<scene version="3.0.0">
    <default name="resx" value="{}"/>
    <default name="resy" value="{}"/>
    <default name="spp" value="64"/>

    <integrator type="direct"/>

    <sensor type="perspective">
        <float name="fov" value="{}"/>
{}        <transform name="to_world">
            {}
        </transform>
        <sampler type="independent">
            <integer name="sample_count" value="$spp"/>
        </sampler>
        <film type="hdrfilm">
            <integer name="width" value="$resx"/>
            <integer name="height" value="$resy"/>
            <string name="pixel_format" value="rgb"/>
        </film>
    </sensor>
)";

/// Empty where the value is the usual one.
std::string float_text(const char* name, double value, double usual) {
    if (value == usual) return "";
    return fmt::format("        <float name=\"{}\" value=\"{:.9g}\"/>\n", name, value);
}

}  // namespace

std::string scene_top(const SensorText& sensor) {
    const SensorText usual;
    const std::string others =
        float_text("near_clip", sensor.near, usual.near) +
        float_text("far_clip", sensor.far, usual.far) +
        float_text("principal_point_offset_x", sensor.offset_x, usual.offset_x) +
        float_text("principal_point_offset_y", sensor.offset_y, usual.offset_y);
    return fmt::format(kHead, sensor.width, sensor.height, sensor.fov, others, sensor.to_world);
}

std::string scene_head(const std::string& name, const std::string& parameter, const View& view) {
    SensorText sensor;
    sensor.fov = view.fov;
    sensor.to_world = fmt::format(
        "<lookat origin=\"{}, {}, {}\" target=\"{}, {}, {}\" up=\"0, 1, 0\"/>", view.origin.x,
        view.origin.y, view.origin.z, view.target.x, view.target.y, view.target.z);
    return fmt::format(
               "<!-- Made by `burnish scene {}`. The texture to recover is {}. Licence: see "
               "LICENSE. "
               "-->\n",
               name, parameter) +
           scene_top(sensor);
}

std::string rgb(const char* name, const Rgbf& c) {
    return fmt::format("<rgb name=\"{}\" value=\"{:.4f}, {:.4f}, {:.4f}\"/>", name, c.x, c.y, c.z);
}

std::string ply_shape(const std::string& name, const std::string& bsdf,
                      const std::string& to_world) {
    std::string xml = fmt::format(
        "    <shape type=\"ply\" id=\"{0}\">\n"
        "        <string name=\"filename\" value=\"meshes/{0}.ply\"/>\n",
        name);
    if (!to_world.empty())
        xml += fmt::format("        <transform name=\"to_world\">{}</transform>\n", to_world);
    return xml + fmt::format("        <ref id=\"{}\"/>\n    </shape>\n", bsdf);
}

std::string area_light(const std::string& shape, const Rgbf& radiance) {
    return fmt::format("    {}\n        <emitter type=\"area\">{}</emitter>\n    </shape>\n", shape,
                       rgb("radiance", radiance));
}

std::string panel_light(const Panel& panel, const Rgbf& radiance) {
    const Vec3<double>&p = panel.origin, &t = panel.target;
    return area_light(
        fmt::format("<shape type=\"rectangle\"><transform name=\"to_world\"><scale "
                    "x=\"{:.4f}\" y=\"{:.4f}\"/>"
                    "<lookat origin=\"{:.4f}, {:.4f}, {:.4f}\" target=\"{}, {}, {}\" up=\"0, 1, "
                    "0.01\"/></transform>",
                    panel.half_width, panel.half_height, p.x, p.y, p.z, t.x, t.y, t.z),
        radiance);
}

std::string lamp(const std::string& mesh, const Vec3<double>& p, double size,
                 const Rgbf& radiance) {
    return area_light(
        fmt::format("<shape type=\"ply\"><string name=\"filename\" value=\"meshes/{}.ply\"/>"
                    "<transform name=\"to_world\"><scale value=\"{:.4f}\"/>"
                    "<translate x=\"{:.4f}\" y=\"{:.4f}\" z=\"{:.4f}\"/></transform>",
                    mesh, size, p.x, p.y, p.z),
        radiance);
}

}  // namespace burnish::procedural
