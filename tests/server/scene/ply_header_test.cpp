#include "server/scene/assimp/ply_header.h"

#include <gtest/gtest.h>

#include "gltf_file.h"
#include "server/scene/load.h"

namespace macula::scene::assimp {
namespace {

/// What is said of a header of a file of `bytes`; empty when it is taken.
std::string refusal(const std::string& header, std::uint64_t bytes = 1000) {
  const auto checked = check_ply_header(header, bytes, "a.ply");
  return checked ? std::string{} : checked.error().message();
}

std::string header_of(const std::string& elements) {
  return "ply\nformat ascii 1.0\ncomment made by hand\n" + elements + "end_header\n0 0 0\n";
}

TEST(PlyHeader, MayHaveAnyLineEnds) {
  EXPECT_EQ(refusal(header_of("element vertex 3\nproperty float x\n")), "");
  EXPECT_EQ(refusal("ply\r\nformat ascii 1.0\r\n\r\nelement vertex 3\r\nend_header\r\n"), "");
  EXPECT_EQ(refusal("ply \relement vertex 3\rend_header\r"), "");
}

TEST(PlyHeader, MustClaimNoMoreElementsThanThereAreBytes) {
  EXPECT_EQ(refusal(header_of("element vertex 600\nelement face 400\n")), "");
  const std::string sum = refusal(header_of("element vertex 600\nelement face 401\n"));
  EXPECT_NE(sum.find("a.ply: line 5"), std::string::npos) << sum;
  EXPECT_NE(refusal(header_of("element vertex 18446744073709551615\nelement face 2\n")), "");
  for (const char* number : {"", "-1", "3x", "1e3", "99999999999999999999"})
    EXPECT_NE(refusal(header_of(std::string("element vertex ") + number + "\n")), "") << number;
}

TEST(PlyHeader, MustEnd) {
  const std::string endless = refusal("ply\nelement vertex 3\nproperty float x\n");
  EXPECT_NE(endless.find("end_header"), std::string::npos) << endless;
  const std::string damaged = refusal("ply\nelement vertex 3\nen\xFF_header\n0 0 0\n");
  EXPECT_NE(damaged.find("line 3"), std::string::npos) << damaged;
  EXPECT_NE(refusal("solid\n"), "");
  EXPECT_NE(refusal(""), "");
}

/// A fuzzer found it: assimp 5.2.5 reads on beyond the file's end, for ever.
TEST(PlyHeader, WithoutAnEndDoesNotReachTheImporter) {
  const test::TemporaryFolder folder;
  const auto scene =
      load_scene(folder.write("t.ply",
                              "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                              "en\xFF_header\n0\n"));
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message().find("t.ply: line 5"), std::string::npos)
      << scene.error().message();
}

}  // namespace
}  // namespace macula::scene::assimp
