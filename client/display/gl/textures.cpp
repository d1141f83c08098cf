#include "client/display/gl/textures.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace macula::display {
namespace {

template <class T>
const T* turned_over(const image::Plane<T>& picture, std::vector<T>& rows) {
  rows.resize(picture.size());
  auto end = rows.end();
  for (int y = 0; y < picture.height(); ++y) {
    const auto row = picture.row(y);
    end = std::copy_backward(row.begin(), row.end(), end);
  }
  return rows.data();
}

void store(unsigned texture, int width, int height, GLenum format, GLenum type,
           const void* texels) {
  glBindTexture(GL_TEXTURE_2D, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format, type, texels);
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace

void TextureFiller::fill(unsigned texture, const image::Plane<Rgb8>& picture) {
  store(texture, picture.width(), picture.height(), GL_RGB, GL_UNSIGNED_BYTE,
        turned_over(picture, colors_));
}

void TextureFiller::fill_depth(unsigned texture, const image::Plane<float>& depth) {
  store(texture, depth.width(), depth.height(), GL_DEPTH_COMPONENT, GL_FLOAT,
        turned_over(depth, depths_));
}

}  // namespace macula::display
