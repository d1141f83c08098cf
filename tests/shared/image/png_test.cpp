#include "shared/image/png.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace macula::image {
namespace {

using Bytes = std::vector<std::byte>;

std::string temporary_path(const std::string& file) {
  return (std::filesystem::path(::testing::TempDir()) / ("macula_png_test_" + file)).string();
}

Plane<Rgb8> random_picture(int width, int height) {
  std::mt19937 random(static_cast<unsigned>(width * 1000 + height));
  Plane<Rgb8> picture(width, height);
  for (auto& pixel : picture.pixels()) {
    const auto bits = static_cast<std::uint32_t>(random());
    pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
             static_cast<std::uint8_t>(bits >> 16)};
  }
  return picture;
}

Bytes file_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

// ------------------------------------------------- a PNG writer of the formats write_png never
// uses

void append_u32(Bytes& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    out.push_back(static_cast<std::byte>((value >> shift) & 0xFFU));
}

/// CRC-32 of ISO 3309, bit by bit.
std::uint32_t crc32(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

void append_chunk(Bytes& out, const char* type, const Bytes& data) {
  append_u32(out, static_cast<std::uint32_t>(data.size()));
  Bytes body;
  for (int i = 0; i < 4; ++i) body.push_back(static_cast<std::byte>(type[i]));
  body.insert(body.end(), data.begin(), data.end());
  out.insert(out.end(), body.begin(), body.end());
  append_u32(out, crc32(body));
}

/// A zlib stream with one stored block (RFC 1950 and 1951), up to 65535 bytes.
Bytes zlib_stored(const Bytes& raw) {
  Bytes out{std::byte{0x78}, std::byte{0x01}, std::byte{0x01}};
  const auto size = static_cast<std::uint32_t>(raw.size());
  for (const std::uint32_t half : {size, ~size}) {
    out.push_back(static_cast<std::byte>(half & 0xFFU));
    out.push_back(static_cast<std::byte>((half >> 8) & 0xFFU));
  }
  out.insert(out.end(), raw.begin(), raw.end());
  std::uint32_t a = 1, b = 0;
  for (const std::byte byte : raw) {
    a = (a + static_cast<std::uint32_t>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  append_u32(out, (b << 16) | a);
  return out;
}

struct Chunk {
  const char* type;
  Bytes data;
};

Bytes bytes_of(std::initializer_list<int> values) {
  Bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

/// `raw` has a filter byte 0 before each row.
Bytes make_png(std::uint32_t width, std::uint32_t height, int depth, int color_type,
               const std::vector<Chunk>& ancillary, const Bytes& raw) {
  Bytes out = bytes_of({0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'});
  Bytes header;
  append_u32(header, width);
  append_u32(header, height);
  for (const int value : {depth, color_type, 0, 0, 0})
    header.push_back(static_cast<std::byte>(value));
  append_chunk(out, "IHDR", header);
  for (const auto& chunk : ancillary) append_chunk(out, chunk.type, chunk.data);
  append_chunk(out, "IDAT", zlib_stored(raw));
  append_chunk(out, "IEND", {});
  return out;
}

void expect_pixel(const Rgba8& pixel, int r, int g, int b, int a) {
  EXPECT_EQ(pixel.r, r);
  EXPECT_EQ(pixel.g, g);
  EXPECT_EQ(pixel.b, b);
  EXPECT_EQ(pixel.a, a);
}

// --------------------------------------------------------------------------------------------
// tests

TEST(Png, WhatIsWrittenIsReadBackBitByBit) {
  const auto path = temporary_path("round_trip.png");
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {64, 1}, {131, 67}}) {
    const auto picture = random_picture(width, height);
    ASSERT_TRUE(write_png(path, picture));
    const auto again = read_png(path);
    ASSERT_TRUE(again) << again.error().message();
    ASSERT_EQ(again->rect(), picture.rect());
    EXPECT_TRUE(
        std::equal(again->pixels().begin(), again->pixels().end(), picture.pixels().begin()));
  }
  std::filesystem::remove(path);
}

TEST(Png, OpaquePicturesDecodeWithFullAlpha) {
  const auto path = temporary_path("opaque.png");
  ASSERT_TRUE(write_png(path, Plane<Rgb8>(3, 2, Rgb8{9, 8, 7})));
  const auto decoded = decode_png(file_bytes(path), path);
  ASSERT_TRUE(decoded);
  for (const auto& pixel : decoded->pixels()) expect_pixel(pixel, 9, 8, 7, 255);
  std::filesystem::remove(path);
}

TEST(Png, AlphaIsReturnedBesideUnchangedColour) {
  const auto png = make_png(2, 1, 8, 6, {}, bytes_of({0, 200, 100, 50, 0, 1, 2, 3, 128}));
  const auto decoded = decode_png(png, "rgba");
  ASSERT_TRUE(decoded) << decoded.error().message();
  expect_pixel((*decoded)(0, 0), 200, 100, 50, 0);
  expect_pixel((*decoded)(1, 0), 1, 2, 3, 128);
}

TEST(Png, SixteenBitsRoundToEight) {
  // 0x00FF / 257 = 0.99 rounds to 1; cutting the low byte would say 0.
  const auto png = make_png(1, 1, 16, 2, {}, bytes_of({0, 0x00, 0xFF, 0xFF, 0xFF, 0x00, 0x7F}));
  const auto decoded = decode_png(png, "rgb16");
  ASSERT_TRUE(decoded) << decoded.error().message();
  expect_pixel((*decoded)(0, 0), 1, 255, 0, 255);
}

TEST(Png, GreyOfOneBitBecomesBlackAndWhite) {
  const auto png = make_png(8, 1, 1, 0, {}, bytes_of({0, 0b10100001}));
  const auto decoded = decode_png(png, "grey1");
  ASSERT_TRUE(decoded) << decoded.error().message();
  const int expected[] = {255, 0, 255, 0, 0, 0, 0, 255};
  for (int x = 0; x < 8; ++x)
    expect_pixel((*decoded)(x, 0), expected[x], expected[x], expected[x], 255);
}

TEST(Png, GreyOfSixteenBitsWithAlphaIsKept) {
  const auto png = make_png(1, 1, 16, 4, {}, bytes_of({0, 0x40, 0x40, 0x20, 0x20}));
  const auto decoded = decode_png(png, "grey16a");
  ASSERT_TRUE(decoded) << decoded.error().message();
  expect_pixel((*decoded)(0, 0), 0x40, 0x40, 0x40, 0x20);
}

TEST(Png, PaletteAndItsTransparencyExpand) {
  const std::vector<Chunk> chunks{{"PLTE", bytes_of({255, 0, 0, 0, 255, 0, 0, 0, 255})},
                                  {"tRNS", bytes_of({255, 64})}};
  const auto png = make_png(4, 1, 2, 3, chunks, bytes_of({0, 0b00011000}));
  const auto decoded = decode_png(png, "palette");
  ASSERT_TRUE(decoded) << decoded.error().message();
  expect_pixel((*decoded)(0, 0), 255, 0, 0, 255);
  expect_pixel((*decoded)(1, 0), 0, 255, 0, 64);
  expect_pixel((*decoded)(2, 0), 0, 0, 255, 255);
  expect_pixel((*decoded)(3, 0), 255, 0, 0, 255);
}

TEST(Png, ReadingAFileDropsAlphaWithoutBlending) {
  const auto path = temporary_path("alpha.png");
  const auto png = make_png(1, 1, 8, 6, {}, bytes_of({0, 200, 100, 50, 3}));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  const auto picture = read_png(path);
  ASSERT_TRUE(picture) << picture.error().message();
  EXPECT_EQ((*picture)(0, 0), (Rgb8{200, 100, 50}));
  std::filesystem::remove(path);
}

TEST(Png, EveryTruncationIsAnErrorThatNamesTheFile) {
  const auto path = temporary_path("whole.png");
  ASSERT_TRUE(write_png(path, random_picture(16, 16)));
  const auto whole = file_bytes(path);
  ASSERT_TRUE(decode_png(whole, "whole"));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto cut = decode_png(std::span(whole).first(size), "cut.png");
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().where, "cut.png");
    EXPECT_EQ(cut.error().exit_status(), 2);
  }
  std::filesystem::remove(path);
}

TEST(Png, FlippedBitsNeverCrash) {
  const auto path = temporary_path("flip.png");
  ASSERT_TRUE(write_png(path, random_picture(16, 16)));
  const auto whole = file_bytes(path);
  std::mt19937 random(11);
  for (int i = 0; i < 2000; ++i) {
    auto bytes = whole;
    const auto at = random() % bytes.size();
    bytes[at] ^= static_cast<std::byte>(1U << (random() % 8));
    const auto decoded = decode_png(bytes, "flip", 64);
    if (decoded) {
      EXPECT_LE(decoded->width(), 64);
      EXPECT_LE(decoded->height(), 64);
    }
  }
  std::filesystem::remove(path);
}

TEST(Png, SizesBeyondTheLimitAreRefused) {
  const auto path = temporary_path("large.png");
  ASSERT_TRUE(write_png(path, Plane<Rgb8>(40, 10)));
  EXPECT_TRUE(read_png(path, 40));
  const auto refused = read_png(path, 39);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("40 x 10"), std::string::npos);
  EXPECT_NE(refused.error().message().find("39"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(Png, AHugeClaimInAFewBytesIsRefusedBeforeAllocating) {
  const auto png = make_png(16384, 16384, 8, 6, {}, bytes_of({0, 1, 2, 3, 4}));
  const auto refused = decode_png(png, "bomb");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("cannot hold"), std::string::npos);
}

TEST(Png, MissingFilesFoldersAndOtherFormatsAreOneClearLine) {
  const auto missing = read_png("/nowhere/to/be/found.png");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message().find("/nowhere/to/be/found.png"), std::string::npos);
  EXPECT_FALSE(read_png(::testing::TempDir()));
  EXPECT_FALSE(decode_png(bytes_of({'G', 'I', 'F', '8', '9', 'a', 0, 0, 0, 0}), "gif"));
}

TEST(Png, PicturesThatCannotBeWrittenAreErrors) {
  EXPECT_FALSE(write_png(temporary_path("none.png"), Plane<Rgb8>{}));
  const auto nowhere = write_png("/nowhere/to/be/written.png", Plane<Rgb8>(2, 2));
  ASSERT_FALSE(nowhere);
  EXPECT_NE(nowhere.error().message().find("/nowhere/to/be/written.png"), std::string::npos);
}

}  // namespace
}  // namespace macula::image
