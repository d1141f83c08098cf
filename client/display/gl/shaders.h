// Compiling and linking, for the passes of this room. Internal to it.
#pragma once

#include <epoxy/gl.h>

#include <initializer_list>
#include <string>

#include "shared/base/result.h"

namespace macula::display {

struct ShaderSource {
  GLenum stage;
  const char* text;
};

tl::unexpected<Error> gl_error(std::string what);
/// A linked program; an Error with the driver's own words.
Result<GLuint> build_program(std::initializer_list<ShaderSource> sources);

}  // namespace macula::display
