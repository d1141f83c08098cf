#include "client/display/gl/shaders.h"

#include <array>
#include <vector>

namespace macula::display {
namespace {

Result<GLuint> compile(const ShaderSource& source) {
  const GLuint shader = glCreateShader(source.stage);
  glShaderSource(shader, 1, &source.text, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::array<char, 512> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  return gl_error(std::string("the driver refuses a shader: ") + log.data());
}

Result<GLuint> link(const std::vector<GLuint>& shaders) {
  const GLuint program = glCreateProgram();
  for (const GLuint shader : shaders) glAttachShader(program, shader);
  glLinkProgram(program);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  std::array<char, 512> log{};
  glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteProgram(program);
  return gl_error(std::string("the driver refuses the program: ") + log.data());
}

}  // namespace

tl::unexpected<Error> gl_error(std::string what) {
  return base::runtime_error(std::move(what), "window",
                             "OpenGL 3.3 is needed; without it use --display headless");
}

Result<GLuint> build_program(std::initializer_list<ShaderSource> sources) {
  std::vector<GLuint> shaders;
  Result<GLuint> program = gl_error("nothing to link");
  for (const ShaderSource& source : sources) {
    const auto shader = compile(source);
    if (!shader) {
      program = base::forward(shader);
      break;
    }
    shaders.push_back(*shader);
  }
  if (shaders.size() == sources.size()) program = link(shaders);
  for (const GLuint shader : shaders) glDeleteShader(shader);  // the program keeps what it needs
  return program;
}

}  // namespace macula::display
