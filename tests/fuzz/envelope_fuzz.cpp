// Every message of the wire, as either side decodes it, with the checks that follow; and back:
// what was accepted can be written and read again.
#include "shared/net/wire.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/shared/net/random_messages.h"

namespace macula::fuzz {

void try_input(Input input) {
  const auto bytes = as_bytes(input);
  (void)net::wire_version(bytes);
  const auto message = net::decode_envelope(bytes);
  if (!message) return;
  if (const auto* begin = std::get_if<net::FrameBegin>(&*message))
    (void)net::check_frame_begin(*begin);
  if (const auto* view = std::get_if<net::ViewState>(&*message)) (void)net::check_view_state(*view);
  const std::string again = net::encode_envelope(*message);
  require(net::decode_envelope(std::as_bytes(std::span(again))).has_value(),
          "an accepted message is refused when written again");
}

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    net::RandomMessages random(seed);
    for (const net::Message& message : {net::Message{random.hello()},
                                        {random.welcome()},
                                        {random.refusal()},
                                        {random.settings()},
                                        {random.bye()},
                                        {random.acks()},
                                        {random.view_state()},
                                        {random.frame_begin()},
                                        {random.slice()},
                                        {random.frame_end()},
                                        {random.ping()},
                                        {random.pong()},
                                        {random.beat()}})
      seeds.push_back(net::encode_envelope(message));
  }
  return seeds;
}

}  // namespace macula::fuzz
