// `--live`: a run beside a viewer.
#include "program.h"

#include "live/receiver.h"

namespace burnish {
namespace {

using testing::contains;
using testing::Outcome;
using testing::Receiver;
using testing::TakenPort;

constexpr const char* kLiveRun =
    "optimize --size 32 32 --target-spp 8 --evaluation-spp 8 --iterations 5 -o ";

class LiveRun : public testing::Program {};

TEST_F(LiveRun, IsShown) {
    Receiver receiver;
    const Outcome shown = run(std::string(kLiveRun) + "shown/ --live " + receiver.address());
    EXPECT_EQ(shown.code, 0) << shown.err;
    EXPECT_FALSE(contains(shown.err, "warning")) << shown.err;
    testing::Viewer& viewer = receiver.stop();
    ASSERT_EQ(viewer.images.size(), 3u);
    EXPECT_EQ(viewer.images["shown/view 0"].width, 32);
    EXPECT_EQ(viewer.images["shown/view 0 picture"].width, 32);
    const Image texture =
        read_image((folder / "shown/textures/mat-goblet.brdf_0.roughness.data.exr").string());
    EXPECT_EQ(viewer.images["shown/mat-goblet.brdf_0.roughness.data"].values, texture.values);
}

TEST_F(LiveRun, GoesOnWithoutAViewerAndSaysSoOnce) {
    const TakenPort port;
    const std::string nobody = port.address();
    const Outcome outcome = run(std::string(kLiveRun) + "out --live " + nobody);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::string warning = "burnish: warning: --live: no viewer takes images at " + nobody +
                                " (Connection refused): nothing is shown until one does";
    const std::size_t first = outcome.err.find(warning);
    EXPECT_NE(first, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("--live", first + warning.size()), std::string::npos) << outcome.err;
}

TEST_F(LiveRun, AddressesAreChecked) {
    for (const char* wrong : {"scene.xml", "a:b", "127.0.0.1", "127.0.0.1:99999", "localhost:0"})
        expect_refused(std::string(kLiveRun) + "out --live " + wrong, 2,
                       std::string("--live: found '") + wrong +
                           "', expected HOST:PORT with a port from 1 to 65535");
    expect_refused(std::string(kLiveRun) + "out --live ''", 2,
                   "--live: found an empty text, expected a value");
    // Alone it means the viewer of this machine; what is wrong here is another option.
    expect_refused(std::string(kLiveRun) + "out --live --spp none", 2, "--spp");
}

}  // namespace
}  // namespace burnish
