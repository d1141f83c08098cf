// Keyboard: presses keys in a window of this X server as another of its clients, which is all that
// a window ever knows of a real one. Keys have X's names: "a", "Escape".
#pragma once

#include <memory>
#include <string>

namespace macula::test {

class Keyboard {
 public:
  /// Looks for the window with this title.
  explicit Keyboard(const std::string& title);
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  bool found() const;
  void press(const std::string& key) const;
  void release(const std::string& key) const;

 private:
  struct Parts;
  void send(const std::string& key, int type) const;

  std::unique_ptr<Parts> parts_;
};

}  // namespace macula::test
