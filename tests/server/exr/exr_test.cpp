#include "server/exr/exr.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/handed_data.h"

namespace macula::exr {
namespace {

using std::filesystem::path;

/// A file name of this process in the temporary folder, removed at the end.
class Exr : public testing::Test {
 protected:
  ~Exr() override { std::filesystem::remove(file_); }
  const std::string& file() const { return file_; }
  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_bytes(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary) << bytes;
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

 private:
  std::string file_ =
      (path(testing::TempDir()) / ("macula_exr_" + std::to_string(getpid()) + ".exr")).string();
};

Plane<Rgb> wide_range() {
  Plane<Rgb> picture(37, 19);
  for (int y = 0; y < 19; ++y) {
    for (int x = 0; x < 37; ++x) {
      picture(x, y) = {std::exp2(static_cast<float>(x - 18)), -0.125F * static_cast<float>(y),
                       static_cast<float>(x * 100 + y)};
    }
  }
  return picture;
}

TEST_F(Exr, GivesBackEveryBitOfTheRadianceWritten) {
  const auto picture = wide_range();
  ASSERT_TRUE(write(file(), picture));
  const auto back = read(file());
  ASSERT_TRUE(back) << back.error().message();
  ASSERT_EQ(back->rect(), picture.rect());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    ASSERT_EQ(back->data()[i], picture.data()[i]) << "pixel " << i;
  }
}

TEST_F(Exr, PassesInfinityAndNanThrough) {
  Plane<Rgb> picture(4, 4, Rgb{1.0F});
  picture(2, 1).x = std::numeric_limits<float>::infinity();
  picture(3, 3).z = std::numeric_limits<float>::quiet_NaN();
  ASSERT_TRUE(write(file(), picture));
  const auto back = read(file());
  ASSERT_TRUE(back);
  EXPECT_TRUE(std::isinf((*back)(2, 1).x));
  EXPECT_TRUE(std::isnan((*back)(3, 3).z));
}

TEST_F(Exr, WritesNamedPlanesOfWhichYReadsAsGrey) {
  Plane<float> depth(5, 3, 2.5F), grey(5, 3, 0.25F);
  const NamedPlane planes[] = {{"depth.Z", &depth}, {"Y", &grey}};
  ASSERT_TRUE(write_layers(file(), planes));
  const auto back = read(file());
  ASSERT_TRUE(back) << back.error().message();
  EXPECT_EQ((*back)(4, 2), Rgb{0.25F});
}

TEST_F(Exr, NamesTheChannelsOfAPictureWithoutColour) {
  Plane<float> depth(5, 3, 2.5F);
  const NamedPlane planes[] = {{"depth.Z", &depth}};
  ASSERT_TRUE(write_layers(file(), planes));
  const auto back = read(file());
  ASSERT_FALSE(back);
  EXPECT_TRUE(contains(back.error().message(), "depth.Z")) << back.error().message();
  EXPECT_EQ(back.error().exit_status(), 2);
}

TEST_F(Exr, RefusesAPictureAboveTheLimit) {
  ASSERT_TRUE(write(file(), Plane<Rgb>(40, 4)));
  const auto back = read(file(), 32);
  ASSERT_FALSE(back);
  EXPECT_TRUE(contains(back.error().message(), "40x4")) << back.error().message();
  EXPECT_TRUE(contains(back.error().message(), "1..32")) << back.error().message();
}

TEST_F(Exr, SaysWhatIsWrongWithAMissingOrForeignFile) {
  const auto missing = read(file());
  ASSERT_FALSE(missing);
  EXPECT_TRUE(contains(missing.error().message(), file()));
  EXPECT_TRUE(contains(missing.error().message(), "no such file"));
  write_bytes("this is a letter, not a picture");
  const auto foreign = read(file());
  ASSERT_FALSE(foreign);
  EXPECT_TRUE(contains(foreign.error().message(), "not an OpenEXR file"));
  EXPECT_FALSE(read(testing::TempDir())) << "a folder is no picture";
}

TEST_F(Exr, ATruncatedFileIsAnErrorAtEveryLength) {
  ASSERT_TRUE(write(file(), wide_range()));
  const std::string whole = bytes();
  for (std::size_t length = 0; length + 16 < whole.size(); length += 61) {
    write_bytes(whole.substr(0, length));
    EXPECT_FALSE(read(file())) << length << " of " << whole.size() << " bytes";
  }
}

TEST_F(Exr, AFlippedByteIsAnErrorOrAPictureButNeverACrash) {
  ASSERT_TRUE(write(file(), wide_range()));
  const std::string whole = bytes();
  int refused = 0;
  for (std::size_t place = 0; place < whole.size(); place += 7) {
    std::string broken = whole;
    broken[place] = static_cast<char>(broken[place] ^ 0x5a);
    write_bytes(broken);
    refused += read(file(), 4096) ? 0 : 1;
  }
  EXPECT_GT(refused, 0);
}

TEST_F(Exr, SaysWhereItCannotWrite) {
  const auto result = write("/nonexistent-folder/picture.exr", Plane<Rgb>(2, 2));
  ASSERT_FALSE(result);
  EXPECT_TRUE(contains(result.error().message(), "/nonexistent-folder/picture.exr"));
  EXPECT_EQ(result.error().exit_status(), 2);
}

TEST_F(Exr, ReadsPicturesOfOtherPrograms) {
  MACULA_NEEDS_HANDED_DATA("metrics/veachmis_hdr_ref.exr");
  const auto picture = read((test::handed_data() / "metrics/veachmis_hdr_ref.exr").string());
  ASSERT_TRUE(picture) << picture.error().message();
  EXPECT_EQ(picture->width(), 1280);
  EXPECT_EQ(picture->height(), 720);
}

}  // namespace
}  // namespace macula::exr
