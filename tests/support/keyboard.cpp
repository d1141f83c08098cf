#include "tests/support/keyboard.h"

#include <X11/Xlib.h>

namespace macula::test {
namespace {

::Window find(Display* display, ::Window parent, const std::string& title) {
  char* name = nullptr;
  const bool is_it = XFetchName(display, parent, &name) != 0 && title == name;
  if (name != nullptr) XFree(name);
  if (is_it) return parent;
  ::Window root = 0, of = 0, found = 0;
  ::Window* children = nullptr;
  unsigned count = 0;
  XQueryTree(display, parent, &root, &of, &children, &count);
  for (unsigned i = 0; i < count && found == 0; ++i) found = find(display, children[i], title);
  if (children != nullptr) XFree(children);
  return found;
}

}  // namespace

struct Keyboard::Parts {
  Display* display = nullptr;
  ::Window window = 0;
};

Keyboard::Keyboard(const std::string& title) : parts_(std::make_unique<Parts>()) {
  parts_->display = XOpenDisplay(nullptr);
  if (parts_->display == nullptr) return;
  parts_->window = find(parts_->display, DefaultRootWindow(parts_->display), title);
}

Keyboard::~Keyboard() {
  if (parts_->display != nullptr) XCloseDisplay(parts_->display);
}

bool Keyboard::found() const {
  return parts_->window != 0;
}

void Keyboard::press(const std::string& key) const {
  send(key, KeyPress);
}

void Keyboard::release(const std::string& key) const {
  send(key, KeyRelease);
}

void Keyboard::send(const std::string& key, int type) const {
  XEvent event{};
  event.xkey.type = type;
  event.xkey.display = parts_->display;
  event.xkey.window = parts_->window;
  event.xkey.root = DefaultRootWindow(parts_->display);
  event.xkey.time = CurrentTime;
  event.xkey.same_screen = True;
  event.xkey.keycode = XKeysymToKeycode(parts_->display, XStringToKeysym(key.c_str()));
  XSendEvent(parts_->display, parts_->window, True, KeyPressMask | KeyReleaseMask, &event);
  XSync(parts_->display, False);
}

}  // namespace macula::test
