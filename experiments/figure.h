// What an experiment finds out: numbers, curves and pictures, what the paper says in words, and
// whether it holds here. Made by the experiments, shown by the report.
#pragma once

#include <string>
#include <vector>

#include "image/image.h"

namespace burnish {

/// One number of results.csv.
struct Measurement {
    std::string experiment, scene, variant, metric;
    double value = 0;
};

struct CurvePoint {
    double x = 0, y = 0;
};
struct Curve {
    std::string name;
    std::vector<CurvePoint> points;
};
/// Curves over a common axis; y is logarithmic, x too where `log_x` (then by powers of two). The
/// place of a curve gives it its style; one without points is not shown.
struct Plot {
    std::string x_label, y_label;
    std::vector<Curve> curves;
    bool log_x = false;
};

enum class PictureKind {
    kRadiance,    ///< linear RGB; the report exposes all pictures of a row alike
    kTexture,     ///< texels as they are
    kColor,       ///< linear RGB texels
    kDerivative,  ///< signed: red where positive, blue where negative; full colour at `white`
};
struct Picture {
    std::string name, caption;
    Image image;
    PictureKind kind = PictureKind::kRadiance;
    float white = 1;
};

struct Table {
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
};

/// kUndecided: the intervals of the measurements do not tell; kShown: the paper claims nothing
/// here.
enum class Verdict { kHolds, kPartly, kFails, kUndecided, kShown };
/// Whether a figure has to say why: what was claimed does not hold, or not all of it.
inline bool falls_short(Verdict verdict) {
    return verdict == Verdict::kFails || verdict == Verdict::kPartly;
}

struct Figure {
    std::string title;     ///< of the section
    std::string claim;     ///< what the paper says
    std::string measured;  ///< what was measured here
    std::string why;       ///< where it does not hold: why not, if that was measured
    Verdict verdict = Verdict::kShown;
    std::vector<Table> tables;
    std::vector<Plot> plots;
    std::vector<std::vector<Picture>> pictures;  ///< rows of pictures
};

/// The figures of one experiment, and all of its numbers.
struct ExperimentResult {
    std::string name, title;
    std::vector<Figure> figures;
    std::vector<Measurement> measurements;
    double seconds = 0;
};

}  // namespace burnish
