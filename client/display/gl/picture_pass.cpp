#include "client/display/gl/picture_pass.h"

#include <algorithm>

#include "client/display/gl/shaders.h"
#include "shared/base/check.h"

namespace macula::display {
namespace {

constexpr const char* kVertexShader = R"(#version 330 core
// Two triangles that cover the viewport; v runs down, as pictures do.
out vec2 uv;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  uv = vec2(corner.x, 1.0 - corner.y);
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
)";

constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler2D picture;
uniform vec2 size_px;   // of the rectangle drawn into
uniform vec2 ring_px;   // the gaze, from the rectangle's top left
uniform bool ring_on;
uniform vec4 tangents;        // upper left, lower right
uniform vec3 gaze;
uniform vec3 eccentricities;  // radians
uniform bool eccentricities_on;
in vec2 uv;
out vec4 color;

// White within `half_px` of a line, dark beside it; `off` and its change from pixel to pixel.
void draw_line(float off, float step, float half_px) {
  float off_px = abs(off) / max(step, 1e-9);
  if (off_px < 2.0 * half_px) color.rgb = off_px < half_px ? vec3(1.0) : vec3(0.0);
}

void draw_eccentricities() {
  vec2 tangent = mix(tangents.xy, tangents.zw, uv);
  vec3 sight = normalize(vec3(tangent.x, -tangent.y, -1.0));
  float eccentricity = atan(length(cross(sight, gaze)), dot(sight, gaze));
  float step = length(vec2(dFdx(eccentricity), dFdy(eccentricity)));
  for (int i = 0; i < 3; ++i) draw_line(eccentricity - eccentricities[i], step, 0.75);
}

void main() {
  color = vec4(texture(picture, uv).rgb, 1.0);
  if (eccentricities_on) draw_eccentricities();
  if (ring_on) draw_line(distance(uv * size_px, ring_px) - 14.0, 1.0, 1.25);
}
)";

GLuint make_texture() {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  return name;
}

}  // namespace

Result<std::unique_ptr<PicturePass>> PicturePass::create() {
  if (epoxy_gl_version() < 33) return gl_error("the context is older than OpenGL 3.3");
  const auto program =
      build_program({{GL_VERTEX_SHADER, kVertexShader}, {GL_FRAGMENT_SHADER, kFragmentShader}});
  if (!program) return base::forward(program);
  GLuint vertices = 0;
  glGenVertexArrays(1, &vertices);
  return std::unique_ptr<PicturePass>(new PicturePass(*program, vertices));
}

PicturePass::PicturePass(unsigned program, unsigned vertices)
    : program_(program),
      vertices_(vertices),
      uniforms_{glGetUniformLocation(program, "picture"),
                glGetUniformLocation(program, "size_px"),
                glGetUniformLocation(program, "ring_px"),
                glGetUniformLocation(program, "ring_on"),
                glGetUniformLocation(program, "tangents"),
                glGetUniformLocation(program, "gaze"),
                glGetUniformLocation(program, "eccentricities"),
                glGetUniformLocation(program, "eccentricities_on")} {}

PicturePass::~PicturePass() {
  for (const auto& texture : textures_) glDeleteTextures(1, &texture.name);
  glDeleteVertexArrays(1, &vertices_);
  glDeleteProgram(program_);
}

void PicturePass::upload(std::span<const image::Plane<Rgb8>* const> pictures) {
  while (textures_.size() < pictures.size()) textures_.push_back({make_texture(), {}});
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (std::size_t i = 0; i < pictures.size(); ++i) upload(*pictures[i], textures_[i]);
}

void PicturePass::upload(const image::Plane<Rgb8>& picture, Texture& texture) {
  if (picture.empty()) return;
  glBindTexture(GL_TEXTURE_2D, texture.name);
  if (texture.size.width_px == picture.width() && texture.size.height_px == picture.height()) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, picture.width(), picture.height(), GL_RGB,
                    GL_UNSIGNED_BYTE, picture.data());
    return;
  }
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  MACULA_CHECK(std::max(picture.width(), picture.height()) <= largest,
               "a display picture is larger than any texture");
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width(), picture.height(), 0, GL_RGB,
               GL_UNSIGNED_BYTE, picture.data());
  texture.size = {picture.width(), picture.height()};
}

void PicturePass::set_marks(const PictureMarks& marks, float width_px, float height_px) {
  glUniform2f(uniforms_.size_px, width_px, height_px);
  glUniform1i(uniforms_.ring_on, marks.gaze ? 1 : 0);
  if (marks.gaze)
    glUniform2f(uniforms_.ring_px, marks.gaze->u * width_px, marks.gaze->v * height_px);
  glUniform1i(uniforms_.eccentricities_on, marks.rings ? 1 : 0);
  if (!marks.rings) return;
  const auto& [least, most, gaze, at] = *marks.rings;
  const auto radians = [](Radians angle) { return static_cast<float>(angle.value()); };
  glUniform4f(uniforms_.tangents, least.x, least.y, most.x, most.y);
  glUniform3f(uniforms_.gaze, gaze.x, gaze.y, gaze.z);
  glUniform3f(uniforms_.eccentricities, radians(at[0]), radians(at[1]), radians(at[2]));
}

void PicturePass::draw(PictureSize framebuffer, std::span<const image::Rect> places,
                       std::span<const PictureMarks> marks) {
  MACULA_CHECK(places.size() <= textures_.size(), "a place without a picture");
  glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  glUseProgram(program_);
  glBindVertexArray(vertices_);
  glActiveTexture(GL_TEXTURE0);
  glUniform1i(uniforms_.picture, 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& place = places[i];
    if (place.width <= 0 || place.height <= 0) continue;
    set_marks(i < marks.size() ? marks[i] : PictureMarks{}, static_cast<float>(place.width),
              static_cast<float>(place.height));
    glBindTexture(GL_TEXTURE_2D, textures_[i].name);
    glViewport(place.x, framebuffer.height_px - place.y - place.height, place.width, place.height);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
}

image::Plane<Rgb8> PicturePass::read_back(PictureSize framebuffer) {
  image::Plane<Rgb8> picture(framebuffer.width_px, framebuffer.height_px);
  if (picture.empty()) return picture;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_BACK);
  glReadPixels(0, 0, picture.width(), picture.height(), GL_RGB, GL_UNSIGNED_BYTE, picture.data());
  for (int top = 0, bottom = picture.height() - 1; top < bottom; ++top, --bottom)
    std::swap_ranges(picture.row(top).begin(), picture.row(top).end(), picture.row(bottom).begin());
  return picture;
}

}  // namespace macula::display
