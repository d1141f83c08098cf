#include "client/display/headless/picture_writer.h"

#include <gtest/gtest.h>
#include <filesystem>

#include "shared/image/png.h"

namespace macula::display {
namespace {

class PictureFolder : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::unique_ptr<PictureWriter> writer(int every) const {
    PictureOptions options;
    options.folder = folder_.string();
    options.every = every;
    options.sheet_tile_px = 16;
    return std::move(*PictureWriter::create(options));
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("pictures_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

EyePictures eyes(std::uint8_t value) {
  return {image::Plane<Rgb8>(32, 24, {value, 0, 0}), image::Plane<Rgb8>(32, 24, {0, value, 0})};
}

TEST_F(PictureFolder, HoldsEveryNthFrameTheLastTheSheetAndTheMap) {
  const auto pictures = writer(3);
  for (std::uint8_t shown = 0; shown < 7; ++shown) pictures->show(shown, eyes(10 * shown));
  const auto done = pictures->finish(eyes(60), eyes(1));
  ASSERT_TRUE(done) << done.error().message();
  for (const char* name : {"frames/000000_left.png", "frames/000003_right.png",
                           "frames/000006_left.png", "contact_sheet.png", "rate_map.png"}) {
    EXPECT_TRUE(std::filesystem::exists(file(name))) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(file("frames/000001_left.png")));
  EXPECT_EQ((*image::read_png(file("eye_left.png")))(3, 3), (Rgb8{60, 0, 0}));
  EXPECT_EQ((*image::read_png(file("eye_right.png")))(3, 3), (Rgb8{0, 60, 0}));
  EXPECT_EQ((*image::read_png(file("frames/000003_left.png")))(0, 0), (Rgb8{30, 0, 0}));
  EXPECT_EQ(pictures->written(), 10U);
  EXPECT_EQ(pictures->skipped(), 0U);
}

TEST_F(PictureFolder, IsLeftWithoutPicturesWhenNothingWasShown) {
  const auto pictures = writer(3);
  EXPECT_TRUE(pictures->finish({}, {}));
  EXPECT_EQ(pictures->written(), 0U);
}

TEST(PictureWriter, NamesAFolderThatCannotBeMade) {
  PictureOptions options;
  options.folder = "/proc/macula";
  const auto made = PictureWriter::create(options);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().where, "/proc/macula");
  EXPECT_EQ(made.error().exit_status(), 2);
}

}  // namespace
}  // namespace macula::display
