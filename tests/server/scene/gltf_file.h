// Small glTF files made by tests: one triangle whose JSON a test changes by replacing text, and the
// same as .glb. Written to a folder that goes away with the object.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace macula::scene::test {

using macula::test::TemporaryFolder;

/// `text` with every `from` replaced; the test fails where there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the template has no " << from;
  for (; at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// The triangle (0,0,0) (1,0,0) (0,1,0): 36 bytes of positions, then 6 of indices, padded to 44.
inline std::string triangle_bytes(std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0},
                                  std::vector<std::uint16_t> indices = {0, 1, 2}) {
  std::string bytes(44, '\0');
  std::memcpy(bytes.data(), positions.data(), 36);
  std::memcpy(bytes.data() + 36, indices.data(), 6);
  return bytes;
}

inline std::string triangle_json() {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
         R"("materials":[{"name":"paint"}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},)"
         R"({"buffer":0,"byteOffset":36,"byteLength":6}],)"
         R"("buffers":[{"uri":"t.bin","byteLength":44}]})";
}

inline std::string little_endian(std::uint32_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
  return bytes;
}

/// The same triangle as a binary file.
inline std::string triangle_glb() {
  std::string json = replaced(triangle_json(), R"("uri":"t.bin",)", "");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string binary = triangle_bytes();
  const auto total = static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size());
  return "glTF" + little_endian(2) + little_endian(total) +
         little_endian(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
         little_endian(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) +
         binary;
}

}  // namespace macula::scene::test
