// How long a client waits for what. Internal to this room.
#pragma once

#include <chrono>
#include <cstddef>

namespace macula::net {

inline constexpr std::chrono::milliseconds kStaleAfter{500};
/// Silence that ends the socket: after a damaged length field no error comes, only nothing. Below a
/// second with the new handshake; doubled each time no frame follows, so that a link on which one
/// part takes longer is not cut for ever.
inline constexpr std::chrono::milliseconds kLeastPatience{700}, kMostPatience{5600};
inline constexpr std::chrono::milliseconds kPingEvery{80}, kQuickPingEvery{20},
    kPingAnywayEvery{500};
inline constexpr int kQuickPings = 10;
/// Acks are told again without news, so that a lost one cannot hold a frame's credit.
inline constexpr std::chrono::milliseconds kAckAgainAfter{200}, kProgressAckEvery{50};
inline constexpr std::chrono::milliseconds kHelloAgainAfter{1000}, kHelloAgainAtLeast{100};
/// A server that is full or of another version is asked again, slowly.
inline constexpr std::chrono::milliseconds kAskAgainFull{1000}, kAskAgainRefused{5000};
inline constexpr std::chrono::milliseconds kRetryEvery{1};
/// Beats that come while a frame's parts stay away.
inline constexpr int kBeatsThatEndAFrame = 5;
inline constexpr std::size_t kMostMessages = 64;

}  // namespace macula::net
