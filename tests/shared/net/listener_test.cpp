#include "shared/net/listener.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <string>

#include "shared/net/wakeup.h"

namespace macula::net {
namespace {

int not_sent_lowat(int fd) {
  int bytes = -1;
  socklen_t size = sizeof bytes;
  EXPECT_EQ(::getsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &bytes, &size), 0);
  return bytes;
}

Fd connected_to(const std::string& endpoint) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Fd fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  EXPECT_EQ(::connect(fd.value(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  return fd;
}

// A kernel buffer of its usual size holds over 100 ms of frames on a slow link; libzmq has no
// option for it, so a connection must have it from the socket it was accepted on.
TEST(Listener, WhatItAcceptsKeepsAtMost16KilobytesUnsentInTheKernel) {
  const auto listener = listen_on("tcp://127.0.0.1:0");
  ASSERT_TRUE(listener) << listener.error().message();
  const Fd client = connected_to(listener->endpoint);
  const Fd accepted(::accept(listener->fd.value(), nullptr, nullptr));
  ASSERT_TRUE(accepted.valid());
  EXPECT_EQ(not_sent_lowat(accepted.value()), 16384);
  EXPECT_NE(not_sent_lowat(client.value()), 16384) << "it is not the system's own setting";
}

}  // namespace
}  // namespace macula::net
