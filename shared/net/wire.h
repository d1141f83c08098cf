// Messages <-> bytes. Part 0 is "MAC" + version byte, then one protobuf Envelope. Decoding checks
// every limit and value (finite, unit, in range) before it hands a struct out.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "shared/base/result.h"
#include "shared/net/messages.h"

namespace macula::net {

std::string encode_envelope(const Message& message);

/// `peer_version` of the error text names both versions when the magic fits but the version does
/// not.
Result<Message> decode_envelope(std::span<const std::byte> part0, const Limits& limits = {});

/// The version byte of a part 0 with our magic, so that a mismatch can be answered with a Refusal.
std::optional<std::uint8_t> wire_version(std::span<const std::byte> part0);

/// Whether a ViewState may reach a renderer: finite, unit quaternions, valid fovs, 1..2 eyes. The
/// error says which field.
Result<void> check_view_state(const ViewState& view);
/// Whether a directory fits the limits and its own views (rects inside grids, sizes, sums).
Result<void> check_frame_begin(const FrameBegin& begin, const Limits& limits = {});

}  // namespace macula::net
