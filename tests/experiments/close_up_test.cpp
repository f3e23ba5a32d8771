// The part of a picture that a figure shows by itself.
#include "experiments/close_up.h"

#include <gtest/gtest.h>

namespace burnish {
namespace {

TEST(CloseUp, IsWherePicturesDifferMost) {
    const Image a = make_image(12, 9, 3, 0.5f);
    Image b = a;
    b.at(0, 0, 0) += 1;     // the largest difference of one pixel
    b.at(9, 6, 1) -= 0.6f;  // the two that are close to each other are more in sum
    b.at(11, 8, 2) += 0.6f;
    for (const Square& square : {most_different(a, b), most_different(b, a)}) {
        EXPECT_EQ(square.side, 3);
        EXPECT_EQ(square.x, 9);
        EXPECT_EQ(square.y, 6);
    }
    const Image part = close_up(b, {9, 6, 3});
    ASSERT_EQ(part.width, 3);
    ASSERT_EQ(part.height, 3);
    ASSERT_EQ(part.channels, 3);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x)
            for (int c = 0; c < 3; ++c) EXPECT_EQ(part.at(x, y, c), b.at(9 + x, 6 + y, c));
}

TEST(CloseUp, ASmallPictureIsOnePixel) {
    const Square square = most_different(make_image(2, 1, 1, 0.0f), make_image(2, 1, 1, 1.0f));
    EXPECT_EQ(square.side, 1);
    EXPECT_EQ(square.x, 0);
    EXPECT_EQ(square.y, 0);
}

}  // namespace
}  // namespace burnish
