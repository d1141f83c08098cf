#include "client/display/gl/warp_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "client/display/gl/shaders.h"
#include "client/display/gl/warp_shaders.h"
#include "client/reprojection/cuts.h"
#include "client/reprojection/mesh.h"
#include "client/reprojection/raster_rules.h"
#include "client/reprojection/resolve.h"

namespace macula::display {
namespace {

using reprojection::Coverage;
using reprojection::WarpOptions;
using reprojection::WarpReport;

GLuint make_texture() {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  return name;
}

void store(GLuint texture, const image::Plane<Rgb8>& picture) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, picture.width(), picture.height(), 0, GL_RGB,
               GL_UNSIGNED_BYTE, picture.data());
}
void store(GLuint texture, const image::Plane<float>& plane) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, plane.width(), plane.height(), 0, GL_RED, GL_FLOAT,
               plane.data());
}
/// 1 becomes 1/255: above 0 is all that is asked.
void store(GLuint texture, const image::Plane<std::uint8_t>& plane) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, plane.width(), plane.height(), 0, GL_RED, GL_UNSIGNED_BYTE,
               plane.data());
}

void bind(GLuint program, const char* name, int unit, GLenum target, GLuint texture) {
  glUniform1i(glGetUniformLocation(program, name), unit);
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target, texture);
}
void set(GLuint program, const char* name, float value) {
  glUniform1f(glGetUniformLocation(program, name), value);
}
void set(GLuint program, const char* name, bool value) {
  glUniform1i(glGetUniformLocation(program, name), value ? 1 : 0);
}
void set(GLuint program, const char* name, const Vec2& value) {
  glUniform2f(glGetUniformLocation(program, name), value.x, value.y);
}
void set(GLuint program, const char* name, const Vec3& value) {
  glUniform3f(glGetUniformLocation(program, name), value.x, value.y, value.z);
}

constexpr GLenum kFloatsOf = GL_TEXTURE_BUFFER;

}  // namespace

Result<std::unique_ptr<WarpPass>> WarpPass::create() {
  if (epoxy_gl_version() < 33) return gl_error("the context is older than OpenGL 3.3");
  const auto mesh = build_program({{GL_VERTEX_SHADER, kCellShader},
                                   {GL_GEOMETRY_SHADER, kQuadShader},
                                   {GL_FRAGMENT_SHADER, kPlaceShader}});
  if (!mesh) return base::forward(mesh);
  const auto resolve =
      build_program({{GL_VERTEX_SHADER, kWholeShader}, {GL_FRAGMENT_SHADER, kResolveShader}});
  if (!resolve) {
    glDeleteProgram(*mesh);
    return base::forward(resolve);
  }
  return std::unique_ptr<WarpPass>(new WarpPass({*mesh, *resolve}));
}

WarpPass::WarpPass(const Programs& programs) : programs_(programs) {
  glGenVertexArrays(1, &vertices_);
  for (FloatBuffer* floats : {&x_tangents_, &y_tangents_}) {
    glGenBuffers(1, &floats->buffer);
    glGenTextures(1, &floats->texture);
  }
  for (Layer* layer : {&seen_, &hidden_}) {
    layer->color = make_texture();
    layer->inverse_depth = make_texture();
    layer->cells = make_texture();
  }
  places_ = make_texture();
  depth_ = make_texture();
  picture_ = make_texture();
  glGenFramebuffers(1, &place_target_);
  glGenFramebuffers(1, &picture_target_);
}

WarpPass::~WarpPass() {
  glDeleteFramebuffers(1, &place_target_);
  glDeleteFramebuffers(1, &picture_target_);
  for (const GLuint texture :
       {places_, depth_, picture_, seen_.color, seen_.inverse_depth, seen_.cells, hidden_.color,
        hidden_.inverse_depth, hidden_.cells, x_tangents_.texture, y_tangents_.texture}) {
    glDeleteTextures(1, &texture);
  }
  glDeleteBuffers(1, &x_tangents_.buffer);
  glDeleteBuffers(1, &y_tangents_.buffer);
  glDeleteVertexArrays(1, &vertices_);
  glDeleteProgram(programs_.mesh);
  glDeleteProgram(programs_.resolve);
}

void WarpPass::upload(const reprojection::SourceView& source) {
  stage_from_view_ = source.stage_from_view;
  grid_ = source.grid;
  has_hidden_ = source.hidden != nullptr;
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  store(seen_.color, source.color);
  store(seen_.inverse_depth, source.inverse_depth_per_m);
  const auto tangents_of = [](const std::vector<float>& tangents, const FloatBuffer& to) {
    glBindBuffer(kFloatsOf, to.buffer);
    glBufferData(kFloatsOf, static_cast<GLsizeiptr>(tangents.size() * sizeof(float)),
                 tangents.data(), GL_STATIC_DRAW);
    glBindTexture(kFloatsOf, to.texture);
    glTexBuffer(kFloatsOf, GL_R32F, to.buffer);
  };
  const foveation::Display any{math::symmetric_fov(Degrees{90.0}, 1.0), 1, 1};
  const reprojection::MeshProjector mesh(source, {}, any);
  tangents_of(mesh.x_tangents(), x_tangents_);
  tangents_of(mesh.y_tangents(), y_tangents_);
  if (!has_hidden_) return;
  store(hidden_.color, source.hidden->color);
  store(hidden_.inverse_depth, source.hidden->inverse_depth_per_m);
  store(hidden_.cells, source.hidden->cells);
}

void WarpPass::resize(PictureSize size) {
  if (size.width_px == size_.width_px && size.height_px == size_.height_px) return;
  size_ = size;
  const auto allocate = [&](GLuint texture, GLint inside, GLenum format, GLenum type) {
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, inside, size.width_px, size.height_px, 0, format, type, nullptr);
  };
  allocate(places_, GL_RGBA32F, GL_RGBA, GL_FLOAT);
  allocate(depth_, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT);
  allocate(picture_, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
  glBindFramebuffer(GL_FRAMEBUFFER, place_target_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, places_, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, picture_target_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, picture_, 0);
}

void WarpPass::set_mesh_uniforms(const Pose& stage_from_display, const foveation::Display& display,
                                 const WarpOptions& options) {
  const image::Plane<Rgb8> no_color;
  const image::Plane<float> no_depth;
  const reprojection::SourceView source{stage_from_view_, grid_, no_color, no_depth};
  const auto relative =
      reprojection::relative_view(stage_from_view_, stage_from_display, options.method);
  const reprojection::MeshProjector mesh(source, relative, display);
  const reprojection::Cuts cuts(mesh, relative, display, options.cut_px);
  const auto& p = mesh.projection();
  const GLuint program = programs_.mesh;
  glUniform2i(glGetUniformLocation(program, "cells"), grid_.width() + 1, grid_.height() + 1);
  set(program, "from_x", p.from_x);
  set(program, "from_y", p.from_y);
  set(program, "from_forward", p.from_forward);
  set(program, "offset_m", p.offset_m);
  set(program, "pixels_per_tangent", p.pixels_per_tangent);
  set(program, "first_pixel", p.first_pixel);
  set(program, "size_px", Vec2(display.width_px, display.height_px));
  const float harmless = cuts.harmless_difference();
  set(program, "harmless", std::min(harmless, std::numeric_limits<float>::max()));
  set(program, "cuts",
      options.silhouettes != WarpOptions::Silhouettes::Stretch && std::isfinite(harmless));
  set(program, "splats", options.silhouettes == WarpOptions::Silhouettes::Splat);
}

void WarpPass::draw_layer(const Layer& layer, int layer_row, const foveation::Display&) {
  const GLuint program = programs_.mesh;
  bind(program, "inverse_depths", 0, GL_TEXTURE_2D, layer.inverse_depth);
  bind(program, "wanted", 1, GL_TEXTURE_2D, layer.cells);
  bind(program, "x_tangents", 2, kFloatsOf, x_tangents_.texture);
  bind(program, "y_tangents", 3, kFloatsOf, y_tangents_.texture);
  set(program, "all_wanted", layer_row == 0);
  set(program, "layer_row", static_cast<float>(layer_row));
  glDrawArrays(GL_POINTS, 0, (grid_.width() + 1) * (grid_.height() + 1));
}

void WarpPass::resolve(const foveation::Display& display, const WarpOptions& options) {
  const GLuint program = programs_.resolve;
  glUseProgram(program);
  glBindFramebuffer(GL_FRAMEBUFFER, picture_target_);
  glDisable(GL_DEPTH_TEST);
  bind(program, "places", 0, GL_TEXTURE_2D, places_);
  bind(program, "seen", 1, GL_TEXTURE_2D, seen_.color);
  bind(program, "hidden", 2, GL_TEXTURE_2D, has_hidden_ ? hidden_.color : seen_.color);
  const auto [u, v] = reprojection::fine_ranges(grid_, display, options.filter);
  glUniform4f(glGetUniformLocation(program, "fine"), u.first, u.last, v.first, v.last);
  set(program, "layer_row", static_cast<float>(reprojection::kSecondLayerRow));
  set(program, "fills", options.holes == WarpOptions::Holes::FillFartherSide);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

WarpReport WarpPass::read_back(image::Plane<Rgb8>& out, image::Plane<Coverage>* coverage) {
  std::vector<std::uint8_t> texels(4 * static_cast<std::size_t>(size_.width_px) *
                                   static_cast<std::size_t>(size_.height_px));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glReadPixels(0, 0, size_.width_px, size_.height_px, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  out.resize(size_.width_px, size_.height_px);
  if (coverage != nullptr) coverage->resize(size_.width_px, size_.height_px, Coverage::Covered);
  WarpReport report;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::uint8_t* const texel = texels.data() + 4 * i;
    out.data()[i] = {texel[0], texel[1], texel[2]};
    const Coverage kind = texel[3] == 255 ? Coverage::Covered
                          : texel[3] == 0 ? Coverage::Outside
                                          : Coverage::Filled;
    ++(kind == Coverage::Covered   ? report.covered_px
       : kind == Coverage::Outside ? report.outside_px
                                   : report.filled_px);
    if (coverage != nullptr) coverage->data()[i] = kind;
  }
  return report;
}

WarpReport WarpPass::warp(const Pose& stage_from_display, const foveation::Display& display,
                          const WarpOptions& options, image::Plane<Rgb8>& out,
                          image::Plane<Coverage>* coverage) {
  MACULA_CHECK(foveation::is_valid(grid_), "a frame must have been uploaded");
  resize({display.width_px, display.height_px});
  glBindVertexArray(vertices_);
  glViewport(0, 0, display.width_px, display.height_px);
  glUseProgram(programs_.mesh);
  glBindFramebuffer(GL_FRAMEBUFFER, place_target_);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
  glClearDepth(0.0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  set_mesh_uniforms(stage_from_display, display, options);
  const auto relative =
      reprojection::relative_view(stage_from_view_, stage_from_display, options.method);
  const bool both =
      has_hidden_ && options.layers == WarpOptions::Layers::Both && relative.offset_m != DVec3{0.0};
  if (both) draw_layer(hidden_, reprojection::kSecondLayerRow, display);
  draw_layer(seen_, 0, display);
  resolve(display, options);
  const WarpReport report = read_back(out, coverage);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindVertexArray(0);
  return report;
}

}  // namespace macula::display
