// Bytes that were damaged, and messages that claim more than there is, in process.
#include <sodium.h>
#include <unistd.h>

#include <random>

#include "client/frames/decode.h"
#include "shared/codec/color.h"
#include "shared/codec/depth.h"
#include "shared/net/frame_assembler.h"
#include "shared/net/wire.h"
#include "tests/client/frames/encoded_frames.h"
#include "tests/faults/faults_fixture.h"

namespace macula::faults {
namespace {

using Bytes = std::vector<std::byte>;

void flip_bit(std::span<std::byte> bytes, std::mt19937_64& random) {
  std::byte& one = bytes[random() % bytes.size()];
  one ^= static_cast<std::byte>(1U << (random() % 8));
}

/// The box that CURVE seals every part with (zmq_curve(7)): X25519, XSalsa20, Poly1305. Under the
/// key of a session, a part in which one bit anywhere was flipped is never opened.
TEST(DataFaults, ASealedPartWithAFlippedBitIsNeverOpened) {
  ASSERT_GE(::sodium_init(), 0);
  std::array<unsigned char, crypto_box_PUBLICKEYBYTES> their_public{}, own_public{};
  std::array<unsigned char, crypto_box_SECRETKEYBYTES> their_secret{}, own_secret{};
  std::array<unsigned char, crypto_box_BEFORENMBYTES> shared{};
  std::array<unsigned char, crypto_box_NONCEBYTES> nonce{};
  ::crypto_box_keypair(their_public.data(), their_secret.data());
  ::crypto_box_keypair(own_public.data(), own_secret.data());
  ASSERT_EQ(::crypto_box_beforenm(shared.data(), their_public.data(), own_secret.data()), 0);
  std::mt19937_64 random(1);
  std::vector<unsigned char> plain(256), sealed(plain.size() + crypto_box_MACBYTES),
      opened(plain.size());
  for (auto& byte : plain) byte = static_cast<unsigned char>(random());
  ASSERT_EQ(::crypto_box_easy_afternm(sealed.data(), plain.data(), plain.size(), nonce.data(),
                                      shared.data()),
            0);
  const auto opens = [&](const std::vector<unsigned char>& part) {
    return ::crypto_box_open_easy_afternm(opened.data(), part.data(), part.size(), nonce.data(),
                                          shared.data()) == 0;
  };
  ASSERT_TRUE(opens(sealed)) << "the twin that must open";
  const int flips = times(100'000, 1'000'000);
  int opened_ones = 0;
  for (int i = 0; i < flips; ++i) {
    std::vector<unsigned char> damaged = sealed;
    flip_bit(std::as_writable_bytes(std::span(damaged)), random);
    opened_ones += opens(damaged) ? 1 : 0;
  }
  EXPECT_EQ(opened_ones, 0);
  note_fault("flipped bits at the AEAD", "0 opened of 1e6 (1e5 in every test run)",
             text(opened_ones, " opened of ", flips));
}

/// A frame of which one bit of a payload or of the messages around it was flipped is refused or
/// decoded to a picture of its size; nothing else happens. (That no such frame arrives at all is
/// the seal's part.)
TEST(DataFaults, ADecoderStandsEveryFlippedBit) {
  const net::ReceivedFrame sound = test::make_received_frame(3, 9);
  const base::ManualClock clock;
  std::mt19937_64 random(2);
  const int flips = times(10'000, 1'000'000);
  int refused = 0, decoded = 0;
  for (int i = 0; i < flips; ++i) {
    net::ReceivedFrame damaged = sound;
    flip_bit(damaged.payloads[random() % damaged.payloads.size()], random);
    const auto frame = frames::FrameDecoder(clock).decode(std::move(damaged));
    (frame ? decoded : refused) += 1;
    for (std::size_t eye = 0; frame && eye < frame->eyes.size(); ++eye) {
      ASSERT_EQ(frame->eyes[eye].color.width(), sound.begin.views[eye].grid.width());
    }
  }
  const std::string begin = net::encode_envelope(sound.begin);
  int envelopes = 0;
  for (int i = 0; i < flips; ++i) {
    std::string damaged = begin;
    flip_bit(std::as_writable_bytes(std::span(damaged)), random);
    const auto message = net::decode_envelope(std::as_bytes(std::span(damaged)));
    envelopes += message ? 1 : 0;
  }
  EXPECT_EQ(refused + decoded, flips);
  note_fault("flipped bits at the decoder", "1e6 (1e4 in every test run) without harm",
             text(2 * flips, " flips: payloads ", refused, " refused, ", decoded,
                  " decoded to their size; headers ", flips - envelopes, " refused, ", envelopes,
                  " within their limits"));
}

double peak_resident_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  }
  return 0.0;
}
void reset_peak() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

net::FrameBegin claimed(const std::function<void(net::FrameBegin&)>& claim) {
  net::FrameBegin begin = test::make_received_frame(3, 9).begin;
  claim(begin);
  return begin;
}

TEST(DataFaults, ClaimsBeyondTheLimitsAreRefusedBeforeAnythingIsAllocated) {
  using Begin = net::FrameBegin;
  const std::vector<std::function<void(Begin&)>> claims{
      [](Begin& b) {
        b.slices[0].rect = {0, 0, 65535, 65535};
      },
      [](Begin& b) { b.slices[0].rect.x = 1 << 30; },
      [](Begin& b) { b.slices[0].rect.width = b.views[0].grid.width() + 1; },
      [](Begin& b) { b.slices[0].size_bytes = 0xFFFFFFFF; },
      [](Begin& b) { b.slices.resize(257, b.slices[0]); },
      [](Begin& b) {
        for (auto* edges : {&b.views[0].grid.x_edges, &b.views[0].grid.y_edges}) {
          edges->resize(20'000);
          for (std::size_t i = 0; i < edges->size(); ++i)
            (*edges)[i] = -1.0F + 1e-4F * static_cast<float>(i);
        }
      }};
  reset_peak();
  const double before = peak_resident_mb();
  int refused = 0;
  for (const auto& claim : claims) {
    const std::string envelope = net::encode_envelope(claimed(claim));
    refused += net::decode_envelope(std::as_bytes(std::span(envelope))) ? 0 : 1;
  }
  EXPECT_EQ(refused, static_cast<int>(claims.size()));
  // A bomb: zeros that pack a thousandfold, said to be a picture of 16 x 16.
  const int side = 2048;
  const image::Plane<Rgb8> black(side, side);
  const auto bomb = codec::encode_color(black, {0, 0, side, side},
                                        {codec::ColorCodec::Lossless, 85, codec::Chroma::Full});
  const auto deep = codec::encode_depth(image::Plane<float>(side, side, 1.0F));
  ASSERT_TRUE(bomb && deep);
  image::Plane<Rgb8> small(16, 16);
  image::Plane<float> small_depth(16, 16);
  const double prepared = peak_resident_mb();
  reset_peak();
  const double at_rest = peak_resident_mb();
  EXPECT_FALSE(codec::decode_color(*bomb, codec::ColorCodec::Lossless, {0, 0, 16, 16}, small));
  EXPECT_FALSE(codec::decode_depth(deep->bytes, deep->inverse_scale_per_m, small_depth));
  const double grown = peak_resident_mb() - at_rest;
  EXPECT_GT(prepared, before + 10.0) << "the twin: what decoding it whole would take is seen";
#if !defined(__SANITIZE_ADDRESS__)
  EXPECT_LE(grown, 64.0);
#endif
  note_fault("oversize claims, 65535 x 65535, packed bombs", "refused, peak <= limit + 64 MB",
             text(refused + 2, " of ", claims.size() + 2, " refused, peak +", grown, " MB"));
}

}  // namespace
}  // namespace macula::faults
