// Scenes that cannot be used: each gives the sentence with the place, what was found and what was
// expected.
#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>

#include "core/random.h"
#include "file_bytes.h"
#include "mitsuba/temporary_scene.h"
#include "mitsuba/xml.h"

namespace burnish {
namespace {

struct BadScene {
    const char* name;
    const char* children;  ///< of <scene>; the first line is line 2 of the file
    const char* message;   ///< after "FILE:"
};

const BadScene kBadScenes[] = {
    {"UnknownElement", "<shap type='obj'/>",
     "2:1: found the element <shap>, expected one of the scene language"},
    {"UnknownAttribute", "<shape type='cube' colour='red'/>",
     "2:1: <shape> has the attribute \"colour\", expected type"},
    {"MissingAttribute", "<shape type='cube'>\n  <float value='1'/></shape>",
     "3:3: <float> lacks the attribute \"name\""},
    {"Malformed", "<shape type='cube'>\n</shap>", "3:3: malformed XML: Start-end tags mismatch"},
    {"UnresolvedParameter", "<default name='a' value='1'/>\n <shape type='$kind'/>",
     "3:2: the parameter \"$kind\" is not defined, expected <default name=\"kind\" .../> or -D "
     "kind=..."},
    {"UnknownShape", "<shape type='teapot'/>",
     "2:1: unknown shape \"teapot\": expected \"obj\", \"ply\""},
    {"UnsupportedShape", "<shape type='sdfgrid'/>",
     "2:1: shape \"sdfgrid\" is not supported yet: expected \"obj\""},
    {"UnsupportedCurve", "<shape type='bsplinecurve'/>",
     "2:1: shape \"bsplinecurve\" is not supported yet: expected \"obj\""},
    {"Medium", "<medium type='homogeneous' id='fog'/>",
     "2:1: <medium> (participating media) is not supported yet: expected surfaces only"},
    {"MediumOfAShape", "<shape type='cube'>\n<medium name='interior' type='homogeneous'/></shape>",
     "3:1: the participating medium \"interior\" of a shape is not supported yet: expected"},
    {"FlatCylinder", "<shape type='cylinder'><point name='p1' x='0'/></shape>",
     "2:1: the cylinder has the radius 1 and the length 0, expected both above 0"},
    {"SquashedCylinder",
     "<shape type='cylinder'><transform name='to_world'><scale x='2'/></transform></shape>",
     "2:1: \"to_world\" of the cylinder shears, or scales its cross-section"},
    {"EmptyInstance", "<shape type='instance'/>",
     "2:1: the instance names no shapegroup or several, expected one"},
    {"InstanceOfACube", "<shape type='cube' id='c'/><shape type='instance'><ref id='c'/></shape>",
     "2:28: the instance names no shapegroup or several, expected one"},
    {"MaterialOfAnInstance",
     "<shape type='shapegroup' id='g'><shape type='cube'/></shape>\n<shape type='instance'>"
     "<ref id='g'/>\n<bsdf type='diffuse'/></shape>",
     "4:1: found \"bsdf\" inside \"instance\", expected it on the shapes of the shapegroup"},
    {"EmptyGroup", "<shape type='shapegroup'/>",
     "2:1: the shapegroup is empty, expected a shape inside"},
    {"NestedGroup",
     "<shape type='shapegroup'>\n<shape type='instance'><shape type='shapegroup'/></shape></shape>",
     "3:1: found \"instance\" inside \"shapegroup\", expected shapes that hold no others"},
    {"EmitterInAGroup",
     "<shape type='shapegroup'>\n<shape type='cube'><emitter type='area'/></shape></shape>",
     "3:20: an emitter inside \"shapegroup\" is not supported yet: expected one on a shape"},
    {"NoAttribute",
     "<shape type='cube'><bsdf type='diffuse'>\n<texture type='mesh_attribute' "
     "name='reflectance'><string name='name' value='vertex_color'/></texture></bsdf></shape>",
     "3:1: the shape has no attribute \"vertex_color\": expected a PLY mesh that has it"},
    {"UnknownBsdf", "<shape type='cube'>\n<bsdf type='velvet'/></shape>",
     "3:1: unknown bsdf \"velvet\": expected"},
    {"UnsupportedBsdf", "<bsdf type='hair' id='a'/>",
     "2:1: bsdf \"hair\" is not supported yet: expected"},
    {"BsdfOfOldScenes", "<bsdf type='phong' id='a'/>",
     "2:1: bsdf \"phong\" is not supported yet: expected \"roughplastic\" with \"alpha\" = sqrt(2 "
     "/ "
     "(exponent + 2))"},
    {"BsdfWithAnotherName", "<shape type='cube'>\n<bsdf type='mixturebsdf'/></shape>",
     "3:1: bsdf \"mixturebsdf\" is not supported yet: expected \"blendbsdf\" with \"weight\""},
    {"BumpMapWithoutHeights", "<bsdf type='bumpmap' id='a'><bsdf type='diffuse'/></bsdf>",
     "2:1: bsdf \"bumpmap\" has 0 textures, expected 1"},
    {"BumpMapOfNoTexels",
     "<bsdf type='bumpmap' id='a'><bsdf type='diffuse'/>\n<texture type='checkerboard'/></bsdf>",
     "3:1: bsdf \"bumpmap\" has a texture without texels, expected a \"bitmap\""},
    {"UnsupportedEmitter", "<emitter type='sunsky'/>",
     "2:1: emitter \"sunsky\" is not supported yet: expected \"area\""},
    {"UnsupportedSensor", "<sensor type='irradiancemeter'/>",
     "2:1: sensor \"irradiancemeter\" is not supported yet: expected"},
    {"NegativeBeam", "<emitter type='spot'><float name='beam_width' value='-1'/></emitter>",
     "2:1: \"beam_width\" is -1 and \"cutoff_angle\" 20, expected 0 <= beam_width and 0 <"},
    {"SquashedSpot",
     "<emitter type='spot'><transform name='to_world'><scale x='2'/></transform></emitter>",
     "2:1: \"to_world\" of the spot shears or scales its axes differently"},
    {"SquashedProjector",
     "<emitter type='projector'><transform name='to_world'><scale z='2'/></transform></emitter>",
     "2:1: \"to_world\" of the projector shears or scales its axes differently"},
    {"SquashedEnvironment",
     "<emitter type='envmap'><string name='filename' value='a.exr'/><transform "
     "name='to_world'><scale x='2'/></transform></emitter>",
     "2:1: \"to_world\" of the envmap scales or shears, expected a rotation"},
    {"ShearedEnvironment",
     "<emitter type='envmap'><string name='filename' value='a.exr'/><transform "
     "name='to_world'><matrix value='1 0.5 0 0 1 0 0 0 1'/></transform></emitter>",
     "2:1: \"to_world\" of the envmap scales or shears, expected a rotation"},
    {"NegativeEnvironment",
     "<emitter type='envmap'><string name='filename' value='a.exr'/><float name='scale' "
     "value='-1'/></emitter>",
     "2:1: \"scale\" is -1, expected no negative value"},
    {"NoDirection", "<emitter type='directional'><vector name='direction' x='0'/></emitter>",
     "2:1: the direction of the light is 0, expected one to shine along"},
    {"NegativeProjector", "<emitter type='projector'><float name='scale' value='-1'/></emitter>",
     "2:1: \"scale\" is -1, expected no negative value"},
    {"FarPoint", "<emitter type='point'><point name='position' z='-1e19'/></emitter>",
     "2:1: the light is at (0, 0, -1e+19), expected it within 1e+12 of the origin"},
    {"OverflowingPoint",
     "<emitter type='point'><transform name='to_world'><translate x='1'/><scale value='1e38'/>"
     "<scale value='1e38'/><scale value='1e38'/><scale value='1e38'/><scale value='1e38'/>"
     "<scale value='1e38'/><scale value='1e38'/><scale value='1e38'/><scale value='1e38'/>"
     "</transform></emitter>",
     "2:1: the light is at (inf, "},
    {"FarSpot",
     "<emitter type='spot'><transform name='to_world'><translate x='2e12'/></transform></emitter>",
     "2:1: the light is at (2e+12, 0, 0), expected it within 1e+12 of the origin"},
    {"FarProjector",
     "<emitter type='projector'><transform name='to_world'><translate y='2e12'/></transform>"
     "</emitter>",
     "2:1: the light is at (0, 2e+12, 0), expected it within 1e+12 of the origin"},
    {"BrightDirectional",
     "<emitter type='directional'><transform name='to_world'><scale value='1e38'/><scale "
     "value='1e38'/><scale value='1e38'/><scale value='1e38'/><scale value='1e38'/></transform>"
     "</emitter>",
     "2:1: \"irradiance\" times the scale of \"to_world\" is (inf, inf, inf), expected finite"},
    {"BrightProjector",
     "<emitter type='projector'><transform name='to_world'><scale value='1e38'/><scale "
     "value='1e38'/><scale value='1e38'/></transform></emitter>",
     "2:1: \"irradiance\" times \"scale\" and that of \"to_world\" is (inf, inf, inf), expected"},
    {"BrightSpot",
     "<emitter type='spot'><rgb name='intensity' value='1e30'/><rgb name='texture' value='1e30'/>"
     "</emitter>",
     "2:1: \"intensity\" times \"texture\" is (inf, inf, inf), expected finite numbers"},
    {"BrightConstant",
     "<emitter type='constant'><spectrum name='radiance' value='3e38'/></emitter>",
     "2:1: \"radiance\" is (inf, "},
    {"TexturedConstant",
     "<emitter type='constant'><texture type='checkerboard' name='radiance'/></emitter>",
     "2:26: the parameter \"radiance\" as a texture is not supported yet: expected <rgb>"},
    {"ThinLensWithoutAperture", "<sensor type='thinlens'/>",
     "2:1: sensor \"thinlens\" lacks the parameter \"aperture_radius\""},
    {"NegativeFocus",
     "<sensor type='thinlens'><float name='aperture_radius' value='1'/><float "
     "name='focus_distance' value='-1'/></sensor>",
     "2:1: \"aperture_radius\" is 1 and \"focus_distance\" -1, expected numbers"},
    {"SquashedOrthographic",
     "<sensor type='orthographic'><transform name='to_world'><scale x='2'/></transform></sensor>",
     "2:1: \"to_world\" of the orthographic camera shears or scales x and y differently (by 2 and "
     "1)"},
    {"UnknownPixelFormat",
     "<sensor type='perspective'><film type='hdrfilm'><string name='pixel_format' "
     "value='cmyk'/></film></sensor>",
     "2:49: the parameter \"pixel_format\" is \"cmyk\", expected rgb, rgba, luminance"},
    {"UnsupportedIntegrator", "<integrator type='ptracer'/>",
     "2:1: integrator \"ptracer\" is not supported yet: expected \"direct\" or \"path\""},
    {"DepthBelowNone",
     "<integrator type='path'><integer name='max_depth' value='-2'/></integrator>",
     "2:25: the parameter \"max_depth\" is \"-2\", expected an integer in [-1, 1048576]"},
    {"RouletteFromTheStart",
     "<integrator type='prb'><integer name='rr_depth' value='0'/></integrator>",
     "2:24: the parameter \"rr_depth\" is \"0\", expected an integer in [1, 2147483647]"},
    {"UnknownFilter",
     "<sensor type='perspective'><film type='hdrfilm'><rfilter type='sinc'/></film></sensor>",
     "2:49: unknown rfilter \"sinc\": expected \"box\""},
    {"FilterOfNoType",
     "<sensor type='perspective'><film type='hdrfilm'><rfilter type=''/></film></sensor>",
     "2:49: unknown rfilter \"\": expected \"box\""},
    {"ShapeOfTwoTypes", "<shape type='hair heightfield'/>",
     "2:1: unknown shape \"hair heightfield\": expected \"obj\""},
    {"MissingFile", "<shape type='ply'><string name='filename' value='a.ply'/></shape>",
     "2:1: the file \"a.ply\" does not exist, expected it beside"},
    {"NoFilename", "<shape type='obj'/>", "2:1: shape \"obj\" lacks the parameter \"filename\""},
    {"EscapeUp", "<shape type='ply'><string name='filename' value='../a.ply'/></shape>",
     "2:1: the file \"../a.ply\" lies outside the folder of the scene, expected one inside"},
    {"EscapeAbsolute",
     "<emitter type='envmap'><string name='filename' value='/etc/passwd'/></emitter>",
     "2:1: the file \"/etc/passwd\" lies outside the folder of the scene"},
    {"EscapeInclude", "<include filename='../../x.xml'/>",
     "2:1: the file \"../../x.xml\" lies outside the folder"},
    {"EscapePath", "<path value='..'/>",
     "2:1: the file \"..\" lies outside the folder of the scene"},
    {"RefToNothing", "<shape type='cube'><ref id='m'/></shape>",
     "2:20: no element has the id \"m\" that <ref> names"},
    {"RefCycle",
     "<bsdf type='twosided' id='a'><ref id='b'/></bsdf>\n<bsdf type='twosided' id='b'><ref "
     "id='a'/></bsdf>",
     "3:30: the reference to \"a\" is a cycle"},
    {"DuplicateId", "<bsdf type='diffuse' id='a'/>\n<bsdf type='diffuse' id='a'/>",
     "3:1: the id \"a\" is taken by the element at "},
    {"AliasOfNothing", "<alias id='a' as='b'/>",
     "2:1: no element has the id \"a\" that <alias> names"},
    {"NestedAlias", "<shape type='cube'><alias id='a' as='b'/></shape>",
     "2:20: found <alias> inside <shape>, expected it"},
    {"WrongType", "<shape type='sphere'><string name='radius' value='1'/></shape>",
     "2:22: the parameter \"radius\" is a <string>, expected <float>"},
    {"NotANumber", "<shape type='sphere'><float name='radius' value='big'/></shape>",
     "2:22: found \"big\", expected a finite number"},
    {"TwoSigns", "<shape type='sphere'><float name='radius' value='+-1'/></shape>",
     "2:22: found \"+-1\", expected a finite number"},
    {"TwoSignsOfAnInteger",
     "<integrator type='path'><integer name='max_depth' value='+-1'/></integrator>",
     "2:25: the parameter \"max_depth\" is \"+-1\", expected an integer in [-1, 1048576]"},
    {"NotFinite", "<shape type='sphere'><float name='radius' value='inf'/></shape>",
     "2:22: found \"inf\", expected a finite number"},
    {"NotABoolean", "<shape type='cube'><boolean name='flip_normals' value='yes'/></shape>",
     "2:20: the parameter \"flip_normals\" is \"yes\", expected true or false"},
    {"NotAnInteger",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='width' "
     "value='1.5'/></film></sensor>",
     "2:49: the parameter \"width\" is \"1.5\", expected an integer in [1, 32768]"},
    {"HugeFilm",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='width' "
     "value='99999999999'/></film></sensor>",
     "2:49: the parameter \"width\" is \"99999999999\", expected an integer in [1, 32768]"},
    {"FilmOfManyPixels",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='16384'/>"
     "<integer name='height' value='8193'/></film></sensor>",
     "2:28: the picture has 16384 x 8193 pixels, expected at most 134217728 in all"},
    {"CropOutside",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='8'/><integer "
     "name='crop_width' "
     "value='9'/></film></sensor>",
     "2:28: the crop window of 9 x 576 pixels at (0, 0) leaves the film of 8 x 576 pixels"},
    {"CropOffsetAlone",
     "<sensor type='perspective'><film type='hdrfilm'><integer name='crop_offset_x' "
     "value='5'/></film></sensor>",
     "2:28: the crop window of 768 x 576 pixels at (5, 0) leaves the film of 768 x 576 pixels"},
    {"FilterInCapitals",
     "<emitter type='projector'><texture type='bitmap' name='irradiance'><string name='filename' "
     "value='a.png'/>\n<string name='filter_type' value='Nearest'/></texture></emitter>",
     "3:1: the parameter \"filter_type\" is \"Nearest\", expected nearest, bilinear"},
    {"WrapInCapitals",
     "<emitter type='projector'><texture type='bitmap' name='irradiance'><string name='filename' "
     "value='a.png'/>\n<string name='wrap_mode' value='Mirror'/></texture></emitter>",
     "3:1: the parameter \"wrap_mode\" is \"Mirror\", expected repeat, mirror, clamp"},
    {"UnknownChoice", "<sensor type='perspective'><string name='fov_axis' value='z'/></sensor>",
     "2:28: the parameter \"fov_axis\" is \"z\", expected x, y, diagonal, smaller, larger"},
    {"FovAndFocalLength",
     "<sensor type='perspective'><float name='fov' value='40'/><string name='focal_length' "
     "value='50mm'/></sensor>",
     "2:58: found both \"fov\" and \"focal_length\", expected at most one of them"},
    {"ScaledCamera",
     "<sensor type='perspective'><transform name='to_world'><scale "
     "value='2'/></transform></sensor>",
     "2:1: \"to_world\" of the camera scales (by 2) or shears, expected a rotation and "
     "translation"},
    {"ClippingPlanes", "<sensor type='perspective'><float name='near_clip' value='0'/></sensor>",
     "2:1: the clipping planes are 0 and 10000, expected 0 < near_clip < far_clip"},
    {"ExchangedClippingPlanes",
     "<sensor type='perspective'><float name='near_clip' value='1e11'/></sensor>",
     "2:1: the clipping planes are 100000000000 and 10000, expected 0 < near_clip < far_clip"},
    {"ScaledClippingPlanes",
     "<sensor type='orthographic'><float name='near_clip' value='1'/>\n<transform "
     "name='to_world'><scale value='1e12'/></transform></sensor>",
     "2:1: the clipping planes are 1 and 10000 at a scale of 1e+12, expected 0 < near_clip < "
     "far_clip"},
    {"FarNearPlane",
     "<sensor type='perspective'><float name='near_clip' value='1e30'/><float name='far_clip' "
     "value='1e31'/></sensor>",
     "2:1: the near clipping plane is at 1e+30, expected it within 1e+12 of the camera"},
    {"FarFocus",
     "<sensor type='thinlens'><float name='aperture_radius' value='1'/><float "
     "name='focus_distance' value='1e20'/></sensor>",
     "2:1: \"aperture_radius\" is 1 and \"focus_distance\" 1e+20, expected numbers of at least 0 "
     "and 1e-12, and of at most 1e+12"},
    {"NearFocus",
     "<sensor type='thinlens'><float name='aperture_radius' value='1'/><float "
     "name='focus_distance' value='1e-20'/></sensor>",
     "2:1: \"aperture_radius\" is 1 and \"focus_distance\" 1e-20, expected numbers"},
    {"WideAperture",
     "<sensor type='thinlens'><float name='aperture_radius' value='1e19'/></sensor>",
     "2:1: \"aperture_radius\" is 1e+19 and \"focus_distance\" 10000, expected numbers"},
    {"WideOrthographic",
     "<sensor type='orthographic'><transform name='to_world'><scale x='1e20' "
     "y='1e20'/></transform></sensor>",
     "2:1: the camera's rays go 1.25e+20 aside of its axis, expected at most 1e+17"},
    {"WideAndFarSharp",
     "<sensor type='thinlens'><float name='aperture_radius' value='1'/><float "
     "name='focus_distance' value='1e12'/><float name='fov' value='179.9999999999'/></sensor>",
     "2:1: the camera's rays go "},
    {"GivenTwice",
     "<shape type='sphere'><float name='radius' value='1'/><float name='radius' "
     "value='2'/></shape>",
     "2:54: the parameter \"radius\" is given twice (first at "},
    {"EtaAndSpecular",
     "<bsdf type='principled' id='a'><float name='eta' value='1.4'/><float name='specular' "
     "value='0.5'/></bsdf>",
     "2:63: found both \"eta\" and \"specular\", expected at most one of them"},
    {"ReflectanceAboveOne",
     "<bsdf type='diffuse' id='a'><rgb name='reflectance' value='0.5 0.5 1.5'/></bsdf>",
     "2:29: the reflectance \"reflectance\" has the value 1.5, expected values in [0, 1]"},
    {"TransmittingTwosided",
     "<bsdf type='twosided' id='a'>\n<bsdf type='principled'><float name='spec_trans' "
     "value='0.5'/></bsdf></bsdf>",
     "3:1: found a bsdf that transmits inside \"twosided\", expected a reflecting "
     "one"},
    {"TransmittingTwosidedThatIsAllowed",
     "<bsdf type='twosided' id='a'><boolean name='allow_transmission' value='true'/>\n<bsdf "
     "type='dielectric'/></bsdf>",
     "3:1: found a bsdf that transmits inside \"twosided\", expected a reflecting one"},
    {"EmptyTwosided", "<bsdf type='twosided' id='a'/>",
     "2:1: bsdf \"twosided\" has 0 nested bsdfs, expected 1 or 2"},
    {"MissingSpectrum",
     "<emitter type='constant'><spectrum name='radiance' filename='a.spd'/></emitter>",
     "2:26: the file \"a.spd\" does not exist"},
    {"SpectrumWithValueAndFile",
     "<emitter type='constant'><spectrum name='radiance' value='1' filename='a.spd'/></emitter>",
     "2:26: <spectrum> has the attributes \"value\" and \"filename\", expected one"},
    {"SpectrumOfAnotherType",
     "<emitter type='constant'><spectrum name='radiance' type='blackbody'/></emitter>",
     "2:26: spectrum \"blackbody\" has no meaning in RGB, as in Mitsuba's rgb variants: expected "
     "<rgb>"},
    {"UnknownSpectrum",
     "<emitter type='constant'><spectrum name='radiance' type='rainbow'/></emitter>",
     "2:26: unknown spectrum \"rainbow\": expected \"uniform\", \"srgb\""},
    {"SpectrumWithoutItsValue",
     "<emitter type='constant'><spectrum name='radiance' type='uniform'/></emitter>",
     "2:26: spectrum \"uniform\" lacks the parameter \"value\""},
    {"SpectrumOutOfRange",
     "<emitter type='constant'><texture name='radiance' type='srgb'>\n<rgb name='color' "
     "value='1.5'/></texture></emitter>",
     "3:1: the \"color\" of \"srgb\" has the value 1.5, expected values in [0, 1]"},
    {"SpectrumWithMore",
     "<emitter type='constant'><spectrum name='radiance' type='d65'>\n<float name='value' "
     "value='1'/></spectrum></emitter>",
     "3:1: found the parameter \"value\" of spectrum \"d65\", expected \"color\" or \"scale\""},
    {"SpectrumOfDecreasingWavelengths",
     "<emitter type='constant'><spectrum name='radiance' value='700:1, 400:2'/></emitter>",
     "2:26: the spectrum is \"700:1, 400:2\", expected two or more pairs such as"},
    {"SpectrumOfOneWavelength",
     "<emitter type='constant'><spectrum name='radiance' value='700:1'/></emitter>",
     "2:26: the spectrum is \"700:1\", expected two or more pairs such as"},
    {"HexColor", "<bsdf type='diffuse' id='a'><srgb name='reflectance' value='#ff80'/></bsdf>",
     "2:29: found the colour \"#ff80\", expected one such as \"#f9c400\""},
    {"HexColorInRgb",
     "<bsdf type='diffuse' id='a'><rgb name='reflectance' value='#f9c400'/></bsdf>",
     "2:29: found the colour \"#f9c400\" in <rgb>, expected <srgb value=\"#f9c400\"/> or linear"},
    {"TwoNumbers", "<emitter type='constant'><rgb name='radiance' value='1 2'/></emitter>",
     "2:26: the parameter \"radiance\" has 2 numbers, expected 1 or 3"},
    {"NegativeRadiance", "<emitter type='constant'><rgb name='radiance' value='-1'/></emitter>",
     "2:1: \"radiance\" is (-1, -1, -1), expected no negative value"},
    {"TwoEnvironments", "<emitter type='constant'/>\n<emitter type='constant'/>",
     "3:1: found a second environment emitter (first at "},
    {"AreaAlone", "<emitter type='area'/>",
     "2:1: emitter \"area\" stands alone, expected it inside a shape"},
    {"AreaToWorld",
     "<shape type='cube'><emitter type='area'><transform name='to_world'/></emitter></shape>",
     "2:41: found \"to_world\" inside \"area\", expected it in the shape"},
    {"PointInShape", "<shape type='cube'><emitter type='point'/></shape>",
     "2:20: found the emitter \"point\" inside a shape, expected \"area\""},
    {"SingularShape",
     "<shape type='cube'><transform name='to_world'><scale x='0'/></transform></shape>",
     "2:1: \"to_world\" of the shape has no inverse, expected an invertible transform"},
    {"FlatRectangle",
     "<shape type='rectangle'><transform name='to_world'><scale value='1 1 "
     "0'/></transform></shape>",
     "2:1: \"to_world\" of the shape has no inverse, expected an invertible transform"},
    {"FlattenedDisk",  // by rounding it has a determinant
     "<shape type='disk'><transform name='to_world'><matrix value='-0.73 0.69 0.53 -0.49 -0.01 "
     "-0.1 -0.855 0.335 0.165'/></transform></shape>",
     "2:1: \"to_world\" of the shape has no inverse, expected an invertible transform"},
    {"StretchedSphere",
     "<shape type='sphere'><transform name='to_world'><scale x='2'/></transform></shape>",
     "2:1: \"to_world\" of the sphere shears or scales its axes differently, expected one scale"},
    {"FarSphere", "<shape type='sphere'><float name='radius' value='1e30'/></shape>",
     "2:1: the shape reaches to 1e+30, expected it within 1e+12 of the origin"},
    {"FarCube",
     "<shape type='cube'><transform name='to_world'><translate x='-2e12'/></transform></shape>",
     "2:1: the shape reaches to 2e+12, expected it within 1e+12 of the origin"},
    {"FarInstance",
     "<shape type='shapegroup' id='g'><shape type='cube'/></shape>\n<shape type='instance'>"
     "<ref id='g'/><transform name='to_world'><scale value='1e13'/></transform></shape>",
     "3:1: the shape reaches to 1e+13, expected it within 1e+12 of the origin"},
    {"TinyInstance",
     "<shape type='shapegroup' id='g'><shape type='cube'/></shape>\n<shape type='instance'>"
     "<ref id='g'/><transform name='to_world'><scale value='1e-16'/></transform></shape>",
     "3:1: \"to_world\" of the instance shrinks its shapes beyond what a ray can follow, expected "
     "a "
     "scale of 1e-12 or more"},
    {"ShiftedInstance",
     "<shape type='shapegroup' id='g'><shape type='cube'/></shape>\n<shape type='instance'>"
     "<ref id='g'/><transform name='to_world'><scale value='1e-11'/><translate "
     "x='1e6'/></transform></shape>",
     "3:1: \"to_world\" of the instance shrinks its shapes beyond what a ray can follow"},
    {"ShortMatrix",
     "<shape type='cube'><transform name='to_world'><matrix value='1 2 3'/></transform></shape>",
     "2:47: <matrix> has 3 numbers, expected 16 or 9"},
    {"RotateWithoutAxis",
     "<shape type='cube'><transform name='to_world'><rotate angle='3'/></transform></shape>",
     "2:47: <rotate> has no axis, expected x, y, z or value"},
    {"UpAlongTheView",
     "<sensor type='perspective'><transform name='to_world'><lookat origin='1.1,2.3,3.7' "
     "target='0.2,0,0.3' up='0.9,2.3,3.4'/></transform></sensor>",
     "2:55: \"up\" of <lookat> is parallel to the view, expected another direction"},
    {"UnknownTransform",
     "<shape type='cube'><transform name='to_world'><float name='a' "
     "value='1'/></transform></shape>",
     "2:47: found <float> inside <transform>, expected translate, scale, rotate, lookat or matrix"},
};

struct BadScenes : testing::TestWithParam<BadScene> {};

TEST_P(BadScenes, SayWhereAndWhy) {
    const TemporaryFolder folder;
    const auto file =
        write_text(folder, "scene.xml",
                   std::string("<scene version='3.0.0'>\n") + GetParam().children + "\n</scene>\n");
    const std::string error = error_of(file), prefix = file.string() + ":";
    EXPECT_EQ(error.rfind(prefix + GetParam().message, 0), 0u)
        << error << "\nexpected " << GetParam().message;
}

INSTANTIATE_TEST_SUITE_P(Table, BadScenes, testing::ValuesIn(kBadScenes),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(BadSceneFiles, NoSceneAtAll) {
    const TemporaryFolder folder;
    EXPECT_NE(error_of(folder.path / "absent.xml").find("no such file"), std::string::npos);
    EXPECT_NE(error_of(write_text(folder, "a.xml", "")).find("a.xml:1:1: found no XML"),
              std::string::npos);
    EXPECT_NE(error_of(write_text(folder, "a.xml", "<shape type='cube'/>"))
                  .find("1:1: found <shape> at the top"),
              std::string::npos);
    EXPECT_NE(error_of(write_text(folder, "a.xml", "<scene/>"))
                  .find("1:1: <scene> lacks the attribute \"version\""),
              std::string::npos);
    EXPECT_NE(error_of(write_text(folder, "a.xml", "<scene version='4.0.0'/>"))
                  .find("found the version \"4.0.0\", expected at most 3"),
              std::string::npos);
    EXPECT_NE(error_of(write_text(folder, "a.xml", "<scene version='new'/>"))
                  .find("found the version \"new\""),
              std::string::npos);
}

TEST(BadSceneFiles, LinesMayEndInAnyWay) {
    const TemporaryFolder folder;
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const auto file =
            write_text(folder, "a.xml",
                       "<scene version='3.0.0'>" + end + end + " <shape type='blob'/></scene>");
        EXPECT_NE(error_of(file).find("a.xml:3:2: unknown shape"), std::string::npos)
            << error_of(file);
    }
}

TEST(BadSceneFiles, TextsThatAreNotUtf8AreRefused) {
    const TemporaryFolder folder;
    const std::string sentence =
        "found text that is not UTF-8, expected a scene that is saved as UTF-8";
    const std::string text =
        "<?xml version='1.0' encoding='iso-8859-1'?>\n<scene version='3.0.0'>\n"
        "<bsdf type='diffuse' id='caf\xE9'/></scene>\n";
    auto file = write_text(folder, "latin.xml", text);
    EXPECT_EQ(error_of(file), file.string() + ":3:29: " + sentence);
    for (const bool is_big_endian : {false, true}) {
        std::string wide = is_big_endian ? "\xFE\xFF" : "\xFF\xFE";
        for (const char c : std::string("<scene version='3.0.0'/>"))
            wide += is_big_endian ? std::string{'\0', c} : std::string{c, '\0'};
        file = write_text(folder, "wide.xml", wide);
        EXPECT_EQ(error_of(file), file.string() + ":1:1: " + sentence);
    }
    file = write_text(folder, "scene.xml",
                      "<scene version='3.0.0'>\n<include filename='latin.xml'/></scene>");
    EXPECT_NE(error_of(file).find("latin.xml:3:29: " + sentence), std::string::npos);
}

TEST(BadSceneFiles, ANormalMapOfOneChannelIsRefused) {
    const TemporaryFolder folder;
    write_image(folder.path / "gray.png", make_image(2, 2, 1, 0.5f));
    const auto error_with = [&](const std::string& type) {
        return error_of(write_text(
            folder, "a.xml",
            "<scene version='3.0.0'><bsdf type='" + type +
                "' id='m'><bsdf type='diffuse'/>\n<texture type='bitmap' name='normalmap'><string "
                "name='filename' value='gray.png'/><boolean name='raw' value='true'/></texture>"
                "</bsdf><shape type='cube'><ref id='m'/></shape></scene>"));
    };
    EXPECT_NE(error_with("normalmap")
                  .find("a.xml:2:1: the normal map has one channel, expected three: heights belong "
                        "in a \"bumpmap\""),
              std::string::npos)
        << error_with("normalmap");
    EXPECT_EQ(error_with("bumpmap"), "");
}

TEST(BadSceneFiles, ASkyBeyondSinglePrecisionIsRefused) {
    const TemporaryFolder folder;
    write_image(folder.path / "sky.exr", make_image(4, 2, 3, 1e30f));
    const auto error_with = [&](const std::string& scale) {
        return error_of(write_text(folder, "a.xml",
                                   "<scene version='3.0.0'><emitter type='envmap'><string "
                                   "name='filename' value='sky.exr'/><float name='scale' value='" +
                                       scale + "'/></emitter></scene>"));
    };
    EXPECT_NE(error_with("1e30").find("a.xml:1:24: the brightest texel times \"scale\" is (inf, "),
              std::string::npos)
        << error_with("1e30");
    EXPECT_EQ(error_with("1e8"), "");
}

TEST(BadSceneFiles, TexturesOfLightBeyondSinglePrecisionAreRefused) {
    const TemporaryFolder folder;
    write_image(folder.path / "light.exr", make_image(2, 2, 3, 1e30f));
    const auto error_with = [&](const std::string& type, const std::string& texture,
                                const std::string& rest) {
        return error_of(write_text(folder, "a.xml",
                                   "<scene version='3.0.0'><emitter type='" + type +
                                       "'><texture type='bitmap' name='" + texture +
                                       "'><string name='filename' value='light.exr'/></texture>" +
                                       rest + "</emitter></scene>"));
    };
    const auto spot = [&](const std::string& intensity) {
        return error_with("spot", "texture", "<rgb name='intensity' value='" + intensity + "'/>");
    };
    const auto projector = [&](const std::string& scale) {
        return error_with("projector", "irradiance", "<float name='scale' value='" + scale + "'/>");
    };
    EXPECT_NE(spot("0, 1e30, 0").find("1:24: \"intensity\" times \"texture\" is (0, inf, 0), exp"),
              std::string::npos)
        << spot("0, 1e30, 0");
    EXPECT_NE(projector("1e30").find("1:24: \"irradiance\" times \"scale\" and that of "
                                     "\"to_world\" is (inf, inf, inf), expected"),
              std::string::npos)
        << projector("1e30");
    EXPECT_EQ(spot("1e8"), "");
    EXPECT_EQ(projector("1e8"), "");
}

TEST(BadSceneFiles, VerticesFarOutAreWhereTheShapeStands) {
    const TemporaryFolder folder;
    write_text(folder, "far.obj", "v 0 0 0\nv 1e30 0 0\nv 0 1e30 0\nf 1 2 3\n");
    const auto error_with = [&](const std::string& to_world) {
        return error_of(write_text(folder, "a.xml",
                                   "<scene version='3.0.0'><shape type='obj'>"
                                   "<string name='filename' value='far.obj'/>" +
                                       to_world + "</shape></scene>"));
    };
    EXPECT_NE(error_with("").find("a.xml:1:24: the shape reaches to 1e+30, expected"),
              std::string::npos)
        << error_with("");
    EXPECT_EQ(error_with("<transform name='to_world'><scale value='1e-30'/></transform>"), "");
}

TEST(BadSceneFiles, IncludeCyclesAndErrorsInside) {
    const TemporaryFolder folder;
    write_text(folder, "sub/b.xml",
               "<scene version='3.0.0'>\n  <include filename='../a.xml'/></scene>");
    const auto a = write_text(folder, "a.xml",
                              "<scene version='3.0.0'><include filename='sub/b.xml'/></scene>");
    EXPECT_NE(error_of(a).find("sub/b.xml:2:3: the include of "), std::string::npos) << error_of(a);
    write_text(folder, "sub/b.xml", "<scene version='3.0.0'>\n  <shape type='blob'/></scene>");
    EXPECT_NE(error_of(a).find("sub/b.xml:2:3: unknown shape \"blob\""), std::string::npos)
        << error_of(a);
}

TEST(BadSceneFiles, LinksOutOfTheFolderAreRefused) {
    const TemporaryFolder folder;
    write_text(folder, "outside.ply", "ply\n");
    const auto scene =
        write_text(folder, "scene/scene.xml",
                   "<scene version='3.0.0'><shape type='ply'><string name='filename' "
                   "value='link.ply'/></shape></scene>");
    std::filesystem::create_symlink("../outside.ply", folder.path / "scene/link.ply");
    EXPECT_NE(error_of(scene).find("the file \"link.ply\" lies outside the folder of the scene"),
              std::string::npos)
        << error_of(scene);
}

TEST(BadSceneFiles, NamesThatLeadNowhereAreNotOutsideOfTheFolder) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("loop.ply", folder.path / "loop.ply");
    for (const std::string& name : {std::string("loop.ply"), std::string(300, 'a')}) {
        const auto scene =
            write_text(folder, "scene.xml",
                       "<scene version='3.0.0'><shape type='ply'><string name='filename' value='" +
                           name + "'/></shape></scene>");
        EXPECT_NE(error_of(scene).find("the file \"" + name.substr(0, 200) + "\" does not exist"),
                  std::string::npos)
            << error_of(scene);
    }
}

TEST(BadSceneFiles, DeepNestingIsRefused) {
    const TemporaryFolder folder;
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "<bsdf type='twosided'>";
    for (int i = 0; i < 5000; ++i) deep += "</bsdf>";
    const auto file = write_text(folder, "a.xml", "<scene version='3.0.0'>" + deep + "</scene>");
    EXPECT_NE(error_of(file).find("nested deeper than 64"), std::string::npos);
    std::string chain;
    for (int i = 0; i < 20000; ++i)
        chain += "<bsdf type='twosided' id='m" + std::to_string(i) + "'><ref id='m" +
                 std::to_string(i + 1) + "'/></bsdf>\n";
    const auto chained = write_text(
        folder, "a.xml",
        "<scene version='3.0.0'>" + chain + "<bsdf type='diffuse' id='m20000'/></scene>");
    EXPECT_NE(error_of(chained).find("nested too deeply"), std::string::npos);
}

TEST(BadSceneFiles, InstancesOfTooManyShapesAreRefused) {
    const TemporaryFolder folder;
    std::string members, instances;
    for (int i = 0; i < 2000; ++i) members += "<shape type='sphere'/>";
    for (int i = 0; i < 1001; ++i) instances += "<shape type='instance'><ref id='g'/></shape>";
    const auto file = write_text(folder, "a.xml",
                                 "<scene version='3.0.0'><shape type='shapegroup' id='g'>" +
                                     members + "</shape>" + instances + "</scene>");
    EXPECT_NE(error_of(file).find("holds more than 2000000 shapes"), std::string::npos)
        << error_of(file);
}

/// 2^40 shapes, each of which holds none.
TEST(BadSceneFiles, MergesThatHoldOthersTwiceAreRefused) {
    const TemporaryFolder folder;
    std::string merges = "<shape type='merge' id='m0'/>\n";
    for (int i = 0; i < 40; ++i) {
        const std::string ref = "<ref id='m" + std::to_string(i) + "'/>";
        merges +=
            "<shape type='merge' id='m" + std::to_string(i + 1) + "'>" + ref + ref + "</shape>\n";
    }
    for (const std::string group : {"", "<shape type='shapegroup'><ref id='m40'/></shape>"}) {
        const auto file =
            write_text(folder, "a.xml", "<scene version='3.0.0'>" + group + merges + "</scene>");
        const std::string error = error_of(file), prefix = file.string() + ":";
        EXPECT_EQ(error.rfind(prefix, 0), 0u) << error;
        EXPECT_NE(error.find("holds more than 2000000 shapes inside of others"), std::string::npos)
            << error;
    }
}

/// A mesh is read for each that holds it, and with it all of its file, of which it may be a part.
TEST(BadSceneFiles, MergesThatReadAMeshAgainAndAgainAreRefused) {
    const TemporaryFolder folder;
    write_text(folder, "mesh.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
               "property float y\nproperty float z\nelement face 1\n"
               "property list uchar int vertex_indices\nend_header\n" +
                   std::string(36, '\0') + std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13));
    std::filesystem::resize_file(folder.path / "mesh.ply", 1 << 25);
    const auto error_with = [&](int levels) {
        std::string text =
            "<shape type='merge' id='m0'>\n<shape type='ply' id='big'><string name='filename' "
            "value='mesh.ply'/></shape></shape>";
        for (int i = 0; i < levels; ++i) {
            const std::string ref = "<ref id='m" + std::to_string(i) + "'/>";
            text +=
                "<shape type='merge' id='m" + std::to_string(i + 1) + "'>" + ref + ref + "</shape>";
        }
        return error_of(write_text(folder, "a.xml", "<scene version='3.0.0'>" + text + "</scene>"));
    };
    EXPECT_EQ(error_with(2), "");
    const std::string error = error_with(5);
    EXPECT_NE(error.find("a.xml:2:1: the shape is read again for each that holds it"),
              std::string::npos)
        << error;
}

const char* const kTriangleWithColors =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nproperty float r\nproperty float g\nproperty float b\nelement face 1\nproperty list uchar "
    "int vertex_indices\nend_header\n0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n";

/// For each shape whose mesh attributes it reads, with all bsdfs that it refers to.
TEST(BadSceneFiles, BsdfsThatAreReadAgainAndAgainAreRefused) {
    const TemporaryFolder folder;
    write_text(folder, "mesh.ply", kTriangleWithColors);
    const auto error_with = [&](const std::string& bsdfs, int shapes) {
        std::string text = "<bsdf type='diffuse' id='d'/>" + bsdfs;
        for (int i = 0; i < shapes; ++i)
            text +=
                "<shape type='ply'><string name='filename' value='mesh.ply'/><ref id='b0'/>"
                "</shape>";
        return error_of(write_text(folder, "a.xml", "<scene version='3.0.0'>" + text + "</scene>"));
    };
    const auto chain = [](int levels, const std::string& values) {
        const std::string last = std::to_string(levels);
        std::string text = "<bsdf type='diffuse' id='b" + last + "'>" + values +
                           "<texture type='mesh_attribute' name='reflectance'><string name='name' "
                           "value='vertex_color'/></texture></bsdf>";
        for (int i = 0; i < levels; ++i)
            text += "<bsdf type='blendbsdf' id='b" + std::to_string(i) +
                    "'><float name='weight' value='0.5'/><ref id='d'/><ref id='b" +
                    std::to_string(i + 1) + "'/></bsdf>";
        return text;
    };
    const std::string text =
        "<string name='none' value='" + std::string(std::size_t{1} << 20, 'x') + "'/>";
    EXPECT_EQ(error_with(chain(100, ""), 100), "");
    EXPECT_EQ(error_with(chain(1, text), 5), "");
    for (const std::string& error :
         {error_with(chain(100, ""), 4000), error_with(chain(1, text), 600)})
        EXPECT_NE(error.find(": the bsdf is read again for each that holds it"), std::string::npos)
            << error;
}

/// Each reads all below it anew, under names of its own.
TEST(BadSceneFiles, ALargeBsdfThatManyOthersReferToIsRefused) {
    const TemporaryFolder folder;
    std::string large = "<bsdf type='diffuse' id='b0'/>";
    for (int i = 1; i < 120; ++i)
        large += "<bsdf type='blendbsdf' id='b" + std::to_string(i) +
                 "'><float name='weight' value='0.5'/><ref id='b" + std::to_string(i - 1) +
                 "'/><bsdf type='diffuse'/></bsdf>";
    const auto error_with = [&](const std::string& bsdf, int masks) {
        std::string text = "<emitter type='constant'/>" + bsdf;
        for (int i = 0; i < masks; ++i)
            text += "<bsdf type='mask' id='m" + std::to_string(i) + "'><ref id='b119'/></bsdf>";
        return error_of(write_text(folder, "a.xml", "<scene version='3.0.0'>" + text + "</scene>"));
    };
    EXPECT_EQ(error_with(large, 100), "");
    EXPECT_EQ(error_with("<bsdf type='diffuse' id='b119'/>", 20'000), "");
    const std::clock_t begin = std::clock();
    const std::string error = error_with(large, 20'000);
    EXPECT_LT(std::clock() - begin, 20 * CLOCKS_PER_SEC);
    EXPECT_NE(error.find(": the bsdf is read again for each that holds it"), std::string::npos)
        << error;
}

TEST(BadSceneFiles, ALongEmitterThatIsReadAgainAndAgainIsRefused) {
    const TemporaryFolder folder;
    std::string text = "<emitter type='area' id='e'>\n<string name='none' value='" +
                       std::string(1 << 20, 'x') + "'/></emitter>";
    for (int i = 0; i < 600; ++i) text += "<shape type='sphere'><ref id='e'/></shape>";
    const auto file = write_text(folder, "a.xml", "<scene version='3.0.0'>" + text + "</scene>");
    EXPECT_NE(error_of(file).find("a.xml:1:24: the emitter is read again for each that holds it"),
              std::string::npos)
        << error_of(file);
}

/// A value is read for each reference, so it counts before what follows is read.
TEST(BadSceneFiles, ReferencesToMuchTextAreBounded) {
    const TemporaryFolder folder;
    std::string spheres;
    for (int i = 0; i < 300; ++i) spheres += "<shape type='sphere'><ref id='v' name='q'/></shape>";
    const auto error_with = [&](std::size_t bytes) {
        return error_of(write_text(folder, "a.xml",
                                   "<scene version='3.0.0'>" + spheres +
                                       "<shape type='blob'/><string id='v' name='v' value='" +
                                       std::string(bytes, 'x') + "'/></scene>"));
    };
    const std::string error = error_with(1'000'000);
    EXPECT_NE(error.find("the values that references mean hold more than 268435456 bytes"),
              std::string::npos)
        << error;
    EXPECT_NE(error_with(100'000).find("unknown shape \"blob\""), std::string::npos);
}

/// Names are looked up among all children: 2 10^10 comparisons one by one.
TEST(BadSceneFiles, ManyShapesOfAMergeAreReadSoon) {
    const TemporaryFolder folder;
    std::string members;
    for (int i = 0; i < 200'000; ++i) members += "<shape type='blob'/>";
    const auto file =
        write_text(folder, "a.xml",
                   "<scene version='3.0.0'><shape type='merge'>" + members + "</shape></scene>");
    const std::clock_t begin = std::clock();
    EXPECT_NE(error_of(file).find("unknown shape \"blob\""), std::string::npos) << error_of(file);
    EXPECT_LT(std::clock() - begin, 10 * CLOCKS_PER_SEC);
}

/// Each has tables of thousands of integrals.
TEST(BadSceneFiles, ManyEqualRoughPlasticsAreReadSoon) {
    const TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 2000; ++i) text += "<bsdf type='roughplastic'/>";
    const auto file = write_text(folder, "a.xml", "<scene version='3.0.0'>" + text + "</scene>");
    const std::clock_t begin = std::clock();
    EXPECT_EQ(error_of(file), "");
    EXPECT_LT(std::clock() - begin, 10 * CLOCKS_PER_SEC);
}

TEST(BadSceneFiles, ManyDifferentRoughPlasticsAreRefusedSoon) {
    const TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 4097; ++i)
        text += "<bsdf type='roughplastic'><float name='alpha' value='0." + std::to_string(i) +
                "1'/></bsdf>";
    const auto file = write_text(folder, "a.xml", "<scene version='3.0.0'>" + text + "</scene>");
    const std::clock_t begin = std::clock();
    EXPECT_NE(error_of(file).find("more than 4096 \"roughplastic\" differ in \"distribution\""),
              std::string::npos)
        << error_of(file);
    EXPECT_LT(std::clock() - begin, 10 * CLOCKS_PER_SEC);
}

TEST(BadSceneFiles, AFileThatIsMissingIsLookedForOnce) {
    const TemporaryFolder folder;
    const auto file = write_text(folder, "a.xml", "<scene version='3.0.0'/>");
    const mitsuba::Document document = mitsuba::parse_document(file, {});
    const auto found = [&] { return mitsuba::find_file(document, document.root.place, "b.png"); };
    EXPECT_EQ(found(), "");
    write_text(folder, "b.png", "");
    EXPECT_EQ(found(), "");
    document.files.clear();
    EXPECT_EQ(found().filename(), "b.png");
}

TEST(BadSceneFiles, TooManyElementsAreRefused) {
    const TemporaryFolder folder;
    std::string text = "<scene version='3.0.0'>\n";
    for (int i = 0; i < 1'000'000; ++i) text += "<ref id='a'/>";
    const std::string error = error_of(write_text(folder, "a.xml", text + "</scene>"));
    EXPECT_NE(error.find("a.xml:2:"), std::string::npos) << error;
    EXPECT_NE(error.find(": the scene has more than 1000000 elements"), std::string::npos) << error;
}

/// Each file is counted as often as it is included.
TEST(BadSceneFiles, IncludedFilesOfTooManyBytesAreRefused) {
    const TemporaryFolder folder;
    std::string blanks = "<scene version='3.0.0'/>";
    blanks.resize(std::size_t{1} << 25, ' ');
    write_text(folder, "blanks.xml", blanks);
    std::string text = "<scene version='3.0.0'>\n";
    for (int i = 0; i < 17; ++i) text += "<include filename='blanks.xml'/>\n";
    const std::string error = error_of(write_text(folder, "a.xml", text + "</scene>"));
    EXPECT_NE(error.find("a.xml:18:1: the files that the scene includes hold more than 536870912 "
                         "bytes, expected at most as many"),
              std::string::npos)
        << error;
}

/// Damaged scene files load or throw InputError.
TEST(BadSceneFiles, CutAndFlippedTextNeverCrashes) {
    const TemporaryFolder folder;
    const std::filesystem::path data = std::filesystem::path(BURNISH_TEST_DATA) / "scenes";
    std::filesystem::copy(data / "assets", folder.path / "assets");
    const std::string text = test::bytes_of(data / "language.xml");
    int refused = 0;
    for (std::uint32_t trial = 0; trial < 300; ++trial) {
        const auto random =
            philox4x32({trial, 0, 0, 0}, {11, static_cast<std::uint32_t>(Stream::kTest)});
        std::string bytes = text;
        bytes[random[0] % text.size()] = static_cast<char>(random[1]);
        if (trial % 3 == 0) bytes.resize(random[2] % text.size());
        refused += !error_of(write_text(folder, "scene.xml", bytes)).empty();
    }
    EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace burnish
