// The CPU visibility buffer beside OSMesa and Embree: fronts of box cities, streets and overviews, 1280 x 720, and item
// buffers of 6 x 256 x 256. All in one run, so that columns compare; times of different runs do not.
//
//   bench_raster --benchmark_filter=Frame        ours, by processor and threads; raster alone and with shading
//   LP_NUM_THREADS=1 bench_raster ...            OSMesa's threads can only be chosen for a whole run (default here: 2)
//   PROMENADE_BENCH_TRIANGLES=1000000 ...        only that size; the larger cities take gigabytes
//
// OSMesa draws textured, unlit, nodes culled by the frustum and sorted from near to far: less work than ours.

#include <GL/osmesa.h>
#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>
#include <immintrin.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>

#include "geometry/camera.h"
#include "raster/shade.h"
#include "raster/visibility.h"

namespace {

using namespace promenade;  // NOLINT(google-build-using-namespace)

constexpr float kPitchM = 22, kSideM = 12;

uint64_t hash(uint64_t z) {
  z = (z + 0x9e3779b97f4a7c15ULL) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 29)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 32);
}

/// A wall of cells, each a quad; every other one recessed by its frame (a window: five quads).
void add_wall(Mesh& mesh, const glm::vec3& origin, const glm::vec3& along, const glm::vec3& up, uint32_t columns,
              uint32_t rows) {
  const glm::vec3 inwards = -glm::normalize(glm::cross(along, up)) * 0.25F;
  const auto quad = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : {a, b, c, d}) {
      mesh.positions.push_back(p);
      mesh.texcoords.emplace_back(glm::dot(p - origin, glm::normalize(along)) / 4,
                                  glm::dot(p - origin, glm::normalize(up)) / 4);
    }
    for (const uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + i);
  };
  const auto at = [&](float x, float y) { return origin + along * (x / float(columns)) + up * (y / float(rows)); };
  for (uint32_t r = 0; r < rows; ++r) {
    for (uint32_t c = 0; c < columns; ++c) {
      const glm::vec3 p[4] = {at(float(c), float(r)), at(float(c + 1), float(r)), at(float(c + 1), float(r + 1)),
                              at(float(c), float(r + 1))};
      if ((r + c) % 2 == 0) {
        quad(p[0], p[1], p[2], p[3]);
        continue;
      }
      quad(p[0] + inwards, p[1] + inwards, p[2] + inwards, p[3] + inwards);
      for (int i = 0; i < 4; ++i) quad(p[i], p[(i + 1) % 4], p[(i + 1) % 4] + inwards, p[i] + inwards);
    }
  }
}

/// A building of about a thousand triangles on its plot of street.
Mesh building(uint32_t column, uint32_t row) {
  Mesh mesh;
  const uint64_t h = hash(uint64_t(column) << 32 | row);
  const glm::vec3 low(float(column) * kPitchM, float(row) * kPitchM, 0);
  const float height = 8 + float(h % 30);
  const glm::vec3 x(kSideM, 0, 0), y(0, kSideM, 0), z(0, 0, height);
  add_wall(mesh, low, x, z, 6, 7);
  add_wall(mesh, low + x, y, z, 6, 7);
  add_wall(mesh, low + x + y, -x, z, 6, 7);
  add_wall(mesh, low + y, -y, z, 6, 7);
  add_wall(mesh, low + z, x, y, 2, 2);
  const glm::vec3 plot = low - glm::vec3(kPitchM - kSideM, kPitchM - kSideM, 0);
  add_wall(mesh, plot, glm::vec3(kPitchM, 0, 0), glm::vec3(0, kPitchM, 0), 1, 1);
  return mesh;
}

struct City {
  uint32_t side = 0;
  uint64_t triangles = 0;
  std::vector<Material> materials;
  std::vector<Image> images;
  std::vector<MipTexture> textures;
  std::unique_ptr<SurfaceTable> surfaces;
  std::vector<Mesh> meshes;
  std::vector<PreparedMesh> prepared;
  std::vector<RasterItem> items;
};

Image facade(uint32_t seed) {
  Image image;
  image.width = image.height = 256;
  for (uint32_t y = 0; y < 256; ++y)
    for (uint32_t x = 0; x < 256; ++x) {
      const uint64_t h = hash(uint64_t(seed) << 32 | (y / 8 * 256 + x / 16));
      const auto tone = static_cast<uint8_t>(140 + h % 60 + hash(seed) % 40);
      image.pixels.emplace_back(tone, uint8_t(tone - hash(seed) % 50), uint8_t(tone - hash(seed + 9) % 70),
                                uint8_t(255));
    }
  return image;
}

const City& city(uint64_t triangles) {
  static std::map<uint64_t, std::unique_ptr<City>> made;
  std::unique_ptr<City>& c = made[triangles];
  if (c) return *c;
  made.clear();  // one at a time: they are large
  std::unique_ptr<City>& fresh = made[triangles];
  fresh = std::make_unique<City>();
  City& out = *fresh;
  const size_t each = building(0, 0).triangle_count();
  out.side = std::max(2U, static_cast<uint32_t>(std::lround(std::sqrt(double(triangles) / double(each)))));
  for (uint32_t i = 0; i < 256; ++i) {
    out.images.push_back(facade(i));
    out.textures.push_back(*MipTexture::make(out.images.back()));
    Material m;
    m.texture = i;
    out.materials.push_back(m);
  }
  std::vector<const MipTexture*> pointers;
  for (const MipTexture& t : out.textures) pointers.push_back(&t);
  out.surfaces = std::make_unique<SurfaceTable>(out.materials, pointers);
  for (uint32_t r = 0; r < out.side; ++r) {
    for (uint32_t k = 0; k < out.side; ++k) {
      Mesh mesh = building(k, r);
      mesh.materials.assign(mesh.triangle_count(), uint32_t(hash(r * 7919 + k) % 256));
      out.triangles += mesh.triangle_count();
      out.prepared.push_back(*prepare(mesh, out.materials));
      out.meshes.push_back(std::move(mesh));
    }
  }
  for (uint32_t i = 0; i < out.prepared.size(); ++i) out.items.push_back({&out.prepared[i], i, out.surfaces.get(), {}});
  return out;
}

enum View : int64_t { street, overview };

/// One of eight frames of a walk.
Camera camera_of(const City& c, int64_t view, uint32_t frame) {
  Camera camera;
  const double extent = double(c.side) * kPitchM;
  if (view == street) {
    const double column = std::floor(c.side * (0.2 + 0.06 * frame));
    camera.pose.eye = {column * kPitchM - (kPitchM - kSideM) / 2, extent * (0.1 + 0.07 * frame), 1.7};
    camera.pose.yaw_deg = 90 + 12.0 * (frame % 4) - 18;
  } else {
    camera.pose.eye = {extent * (0.05 + 0.02 * frame), extent * 0.02, 60 + extent * 0.08};
    camera.pose.yaw_deg = 50, camera.pose.pitch_deg = -18;
  }
  return camera;
}

constexpr const char* kViewNames[] = {"street", "overview"};

void report(benchmark::State& state, const City& c) {
  state.counters["triangles"] = double(c.triangles);
  state.counters["frames_per_s"] = benchmark::Counter(double(state.iterations()), benchmark::Counter::kIsRate);
}

double ms_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Arguments: triangles, view, threads, simd, what is done: 0 raster, 1 and shading, 2 and smoothed edges, 3 and
/// gaps between nodes closed, each of which may be off by what a pixel shows 60 m away.
void BM_Frame(benchmark::State& state) {
  const City& c = city(uint64_t(state.range(0)));
  VisibilityOptions options;
  options.threads = unsigned(state.range(2)), options.simd = Simd(state.range(3));
  options.close_gaps = state.range(4) > 2;
  std::vector<RasterItem> items = c.items;
  for (RasterItem& item : items) item.error_m = options.close_gaps ? 0.1F : 0.0F;
  ShadeOptions shading;
  shading.threads = options.threads, shading.simd = options.simd;
  if (supported_simd(options.simd) != options.simd) return state.SkipWithError("this processor lacks it");
  VisibilityBuffer buffer;
  Image image;
  VisibilityStats sum;
  double shade_ms = 0, smooth_ms = 0;
  uint32_t frame = 0;
  for (auto _ : state) {
    const Camera camera = camera_of(c, state.range(1), frame++ % 8);
    if (!buffer.draw(perspective_view(camera, glm::dvec3(0)), items, options).ok()) state.SkipWithError("not drawn");
    auto start = std::chrono::steady_clock::now();
    if (state.range(4) > 0) shade(buffer, shading, image), shade_ms += ms_since(start);
    start = std::chrono::steady_clock::now();
    if (state.range(4) > 1) smooth_edges(buffer, shading, image), smooth_ms += ms_since(start);
    sum.cull_ms += buffer.stats().cull_ms, sum.draw_ms += buffer.stats().draw_ms;
    sum.items += buffer.stats().items;
    sum.items_in_view += buffer.stats().items_in_view, sum.items_drawn += buffer.stats().items_drawn;
    sum.triangles_set_up += buffer.stats().triangles_set_up, sum.triangles_drawn += buffer.stats().triangles_drawn;
  }
  report(state, c);
  const double n = double(state.iterations());
  state.counters["cull_ms"] = sum.cull_ms / n, state.counters["draw_ms"] = sum.draw_ms / n;
  state.counters["shade_ms"] = shade_ms / n, state.counters["smooth_ms"] = smooth_ms / n;
  state.counters["in_view"] = double(sum.items_in_view) / n, state.counters["drawn"] = double(sum.items_drawn) / n;
  state.counters["set_up"] = double(sum.triangles_set_up) / n,
  state.counters["rastered"] = double(sum.triangles_drawn) / n;
  state.counters["items"] = double(sum.items) / n;
  state.SetLabel(std::string(kViewNames[state.range(1)]) + (state.range(4) > 2    ? " smoothed, gaps closed"
                                                            : state.range(4) > 1  ? " smoothed"
                                                            : state.range(4) == 1 ? " shaded"
                                                                                  : " raster"));
}

/// What the machine can do at most, in the same run: bytes a second that one thread reads from memory and from its
/// own cache; multiplications and additions a second on independent floats.
void BM_ReadMemory(benchmark::State& state) {
  std::vector<uint64_t> words(size_t(state.range(0)) / 8, 1);
  for (auto _ : state) {
    uint64_t sum[4] = {};
    for (size_t i = 0; i + 4 <= words.size(); i += 4)
      for (size_t k = 0; k < 4; ++k) sum[k] += words[i + k];
    benchmark::DoNotOptimize(sum);
  }
  state.SetBytesProcessed(state.iterations() * state.range(0));
}

void BM_CopyMemory(benchmark::State& state) {
  std::vector<uint64_t> from(size_t(state.range(0)) / 8, 1), to(from.size());
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size() * 8);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * state.range(0) * 2);  // read and written
}

[[gnu::target("avx512f")]] void multiply_add_512(float* out, int64_t rounds) {
  __m512 a[8];
  for (__m512& v : a) v = _mm512_set1_ps(out[0]);
  const __m512 m = _mm512_set1_ps(0.999F), c = _mm512_set1_ps(0.001F);
  for (int64_t i = 0; i < rounds; ++i)
    for (__m512& v : a) v = _mm512_add_ps(_mm512_mul_ps(v, m), c);
  for (const __m512& v : a) out[0] += v[0];
}

void BM_MultiplyAdd(benchmark::State& state) {
  if (supported_simd(Simd::avx512) != Simd::avx512) return state.SkipWithError("this processor lacks it");
  float out = 1;
  for (auto _ : state) multiply_add_512(&out, 100000), benchmark::DoNotOptimize(out);
  state.counters["flop_per_s"] =
      benchmark::Counter(double(state.iterations()) * 100000 * 8 * 16 * 2, benchmark::Counter::kIsRate);
}

void BM_ItemBuffers(benchmark::State& state) {
  const City& c = city(uint64_t(state.range(0)));
  VisibilityOptions options;
  options.threads = unsigned(state.range(1)), options.simd = Simd(state.range(2));
  VisibilityBuffer buffer;
  uint32_t frame = 0;
  for (auto _ : state) {
    const Camera camera = camera_of(c, street, frame++ % 8);
    for (int face = 0; face < 6; ++face)
      if (!buffer.draw(cube_face_view(camera.pose.eye, face, 256, 0.1), c.items, options).ok())
        state.SkipWithError("not drawn");
  }
  report(state, c);
}

// --- Embree
// ------------------------------------------------------------------------------------------------------------

class EmbreeCity {
 public:
  /// Not "threads=1": that would leave the whole process's TBB, ours included, with one thread. Rays are the caller's.
  explicit EmbreeCity(const City& c) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    for (uint32_t i = 0; i < c.meshes.size(); ++i) {
      const Mesh& m = c.meshes[i];
      RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
      std::memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, m.positions.size()),
                  m.positions.data(), m.positions.size() * 12);
      std::memcpy(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, m.triangle_count()),
                  m.indices.data(), m.indices.size() * 4);
      rtcCommitGeometry(g);
      rtcAttachGeometryByID(scene_, g, i);
      rtcReleaseGeometry(g);
    }
    rtcCommitScene(scene_);
  }
  ~EmbreeCity() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }
  EmbreeCity(const EmbreeCity&) = delete;
  EmbreeCity& operator=(const EmbreeCity&) = delete;

  /// Primary rays in packets of 4 x 4, coherent; depth and ids only.
  void shoot(const RasterView& view, std::vector<uint32_t>& nodes) const {
    nodes.resize(size_t(view.width_px) * view.height_px);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) RTCRayHit16 r;
    alignas(64) int valid[16];
    std::fill(valid, valid + 16, -1);
    const glm::vec3 eye(view.eye), corner(ray_direction(view, 0.5, 0.5));
    const glm::vec3 dx(view.right / view.scale_px), dy(-view.up / view.scale_px);
    for (uint32_t y = 0; y < view.height_px; y += 4)
      for (uint32_t x = 0; x < view.width_px; x += 4) {
        for (uint32_t i = 0; i < 16; ++i) {
          const glm::vec3 d = corner + dx * float(x + i % 4) + dy * float(y + i / 4);
          r.ray.org_x[i] = eye.x, r.ray.org_y[i] = eye.y, r.ray.org_z[i] = eye.z;
          r.ray.dir_x[i] = d.x, r.ray.dir_y[i] = d.y, r.ray.dir_z[i] = d.z;
          r.ray.tnear[i] = 0.1F, r.ray.tfar[i] = 1e30F, r.ray.time[i] = 0, r.ray.mask[i] = ~0U, r.ray.flags[i] = 0;
          r.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID, r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene_, &context, &r);
        for (uint32_t i = 0; i < 16; ++i) nodes[size_t(y + i / 4) * view.width_px + x + i % 4] = r.hit.geomID[i];
      }
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

const EmbreeCity& embree_city(const City& c) {
  static uint64_t of = 0;
  static std::unique_ptr<EmbreeCity> made;
  if (!made || of != c.triangles) made.reset(), made = std::make_unique<EmbreeCity>(c), of = c.triangles;
  return *made;
}

void BM_FrameEmbree(benchmark::State& state) {
  const City& c = city(uint64_t(state.range(0)));
  const EmbreeCity& rays = embree_city(c);
  std::vector<uint32_t> nodes;
  uint32_t frame = 0;
  for (auto _ : state) rays.shoot(perspective_view(camera_of(c, state.range(1), frame++ % 8), glm::dvec3(0)), nodes);
  report(state, c);
  state.SetLabel(kViewNames[state.range(1)]);
}

void BM_ItemBuffersEmbree(benchmark::State& state) {
  const City& c = city(uint64_t(state.range(0)));
  const EmbreeCity& rays = embree_city(c);
  std::vector<uint32_t> nodes;
  uint32_t frame = 0;
  for (auto _ : state) {
    const Camera camera = camera_of(c, street, frame++ % 8);
    for (int face = 0; face < 6; ++face) rays.shoot(cube_face_view(camera.pose.eye, face, 256, 0.1), nodes);
  }
  report(state, c);
}

// --- OSMesa
// --------------------------------------------------------------------------------------------------------------

/// The few old entry points that a textured mesh needs, from OSMesa itself.
struct Gl {
  template <class F>
  static void get(F& f, const char* name) {
    f = reinterpret_cast<F>(OSMesaGetProcAddress(name));
  }
  void (*enable)(GLenum);
  void (*clear_color)(GLfloat, GLfloat, GLfloat, GLfloat);
  void (*clear)(GLbitfield);
  void (*matrix_mode)(GLenum);
  void (*load_matrix)(const GLfloat*);
  void (*client_state)(GLenum);
  void (*vertex_pointer)(GLint, GLenum, GLsizei, const void*);
  void (*texcoord_pointer)(GLint, GLenum, GLsizei, const void*);
  void (*draw_elements)(GLenum, GLsizei, GLenum, const void*);
  void (*gen_buffers)(GLsizei, GLuint*);
  void (*bind_buffer)(GLenum, GLuint);
  void (*buffer_data)(GLenum, GLsizeiptr, const void*, GLenum);
  void (*gen_textures)(GLsizei, GLuint*);
  void (*bind_texture)(GLenum, GLuint);
  void (*tex_image)(GLenum, GLint, GLint, GLsizei, GLsizei, GLint, GLenum, GLenum, const void*);
  void (*tex_parameter)(GLenum, GLenum, GLint);
  void (*finish)();
  Gl() {
    get(enable, "glEnable"), get(clear_color, "glClearColor"), get(clear, "glClear"), get(matrix_mode, "glMatrixMode");
    get(load_matrix, "glLoadMatrixf"), get(client_state, "glEnableClientState"), get(vertex_pointer, "glVertexPointer");
    get(texcoord_pointer, "glTexCoordPointer"), get(draw_elements, "glDrawElements"), get(gen_buffers, "glGenBuffers");
    get(bind_buffer, "glBindBuffer"), get(buffer_data, "glBufferData"), get(gen_textures, "glGenTextures");
    get(bind_texture, "glBindTexture"), get(tex_image, "glTexImage2D"), get(tex_parameter, "glTexParameteri");
    get(finish, "glFinish");
  }
};

class OsMesaCity {
 public:
  explicit OsMesaCity(const City& c) : pixels_(size_t(1280) * 720) {
    setenv("LP_NUM_THREADS", "2", 0);
    context_ = OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, nullptr);
    OSMesaMakeCurrent(context_, pixels_.data(), GL_UNSIGNED_BYTE, 1280, 720);
    gl_ = std::make_unique<Gl>();
    gl_->enable(GL_DEPTH_TEST), gl_->enable(GL_CULL_FACE), gl_->enable(GL_TEXTURE_2D);
    textures_.resize(c.images.size());
    gl_->gen_textures(GLsizei(textures_.size()), textures_.data());
    for (size_t i = 0; i < textures_.size(); ++i) {
      gl_->bind_texture(GL_TEXTURE_2D, textures_[i]);
      gl_->tex_parameter(GL_TEXTURE_2D, 0x8191 /* GL_GENERATE_MIPMAP */, 1);
      gl_->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
      gl_->tex_image(GL_TEXTURE_2D, 0, GL_RGBA, 256, 256, 0, GL_RGBA, GL_UNSIGNED_BYTE, c.images[i].pixels.data());
    }
    buffers_.resize(c.meshes.size() * 2);
    gl_->gen_buffers(GLsizei(buffers_.size()), buffers_.data());
    for (size_t i = 0; i < c.meshes.size(); ++i) {
      const Mesh& m = c.meshes[i];
      std::vector<float> v;
      for (size_t k = 0; k < m.positions.size(); ++k)
        v.insert(v.end(), {m.positions[k].x, m.positions[k].y, m.positions[k].z, m.texcoords[k].x, m.texcoords[k].y});
      gl_->bind_buffer(0x8892, buffers_[2 * i]), gl_->buffer_data(0x8892, GLsizeiptr(v.size() * 4), v.data(), 0x88E4);
      gl_->bind_buffer(0x8893, buffers_[2 * i + 1]);
      gl_->buffer_data(0x8893, GLsizeiptr(m.indices.size() * 4), m.indices.data(), 0x88E4);
    }
  }
  ~OsMesaCity() { OSMesaDestroyContext(context_); }
  OsMesaCity(const OsMesaCity&) = delete;
  OsMesaCity& operator=(const OsMesaCity&) = delete;

  void draw(const City& c, const Camera& camera) {
    gl_->clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const glm::mat4 projection = clip_from_view(camera, 10000), view = view_from_model(camera.pose, glm::dvec3(0));
    gl_->matrix_mode(GL_PROJECTION), gl_->load_matrix(&projection[0][0]);
    gl_->matrix_mode(GL_MODELVIEW), gl_->load_matrix(&view[0][0]);
    gl_->client_state(GL_VERTEX_ARRAY), gl_->client_state(GL_TEXTURE_COORD_ARRAY);
    const Frustum frustum = frustum_of(camera, glm::dvec3(0));
    std::vector<std::pair<float, uint32_t>> order;
    for (uint32_t i = 0; i < c.prepared.size(); ++i)
      if (classify(frustum, c.prepared[i].box) != Overlap::outside)
        order.emplace_back(c.prepared[i].box.distance(glm::vec3(camera.pose.eye)), i);
    std::sort(order.begin(), order.end());
    for (const auto& [distance, i] : order) {
      gl_->bind_texture(GL_TEXTURE_2D, textures_[c.meshes[i].materials[0]]);
      gl_->bind_buffer(0x8892, buffers_[2 * size_t(i)]), gl_->bind_buffer(0x8893, buffers_[2 * size_t(i) + 1]);
      gl_->vertex_pointer(3, GL_FLOAT, 20, nullptr);
      gl_->texcoord_pointer(2, GL_FLOAT, 20, reinterpret_cast<const void*>(12));
      gl_->draw_elements(GL_TRIANGLES, GLsizei(c.meshes[i].indices.size()), GL_UNSIGNED_INT, nullptr);
    }
    gl_->finish();
  }

 private:
  std::vector<uint32_t> pixels_;
  OSMesaContext context_ = nullptr;
  std::unique_ptr<Gl> gl_;
  std::vector<GLuint> textures_, buffers_;
};

void BM_FrameOsMesa(benchmark::State& state) {
  const City& c = city(uint64_t(state.range(0)));
  static uint64_t of = 0;
  static std::unique_ptr<OsMesaCity> made;
  if (!made || of != c.triangles) made.reset(), made = std::make_unique<OsMesaCity>(c), of = c.triangles;
  uint32_t frame = 0;
  for (auto _ : state) made->draw(c, camera_of(c, state.range(1), frame++ % 8));
  report(state, c);
  state.SetLabel(kViewNames[state.range(1)]);
}

/// Size by size, so that a city is made once.
const bool registered = [] {
  const char* only = std::getenv("PROMENADE_BENCH_TRIANGLES");
  const auto add = [](const char* name, auto function, const std::vector<int64_t>& args) {
    benchmark::RegisterBenchmark(name, function)
        ->Args(args)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime()
        ->MinTime(0.4);
  };
  const std::vector<std::pair<int64_t, const char*>> simds = {
      {int64_t(Simd::avx512), "avx512"}, {int64_t(Simd::avx2), "avx2"}, {int64_t(Simd::portable), "portable"}};
  for (const int64_t n : {100000, 300000, 1000000, 5000000}) {
    if (only != nullptr && std::atoll(only) != n) continue;
    for (const int64_t view : {street, overview}) {
      for (const auto& [simd, name] : simds)
        for (const int64_t shading : {0, 1, 2, 3})
          for (const int64_t threads : {1, 2})
            add((std::string("Frame/") + name).c_str(), BM_Frame, {n, view, threads, simd, shading});
      add("Frame/OSMesa", BM_FrameOsMesa, {n, view});
      add("Frame/Embree", BM_FrameEmbree, {n, view});
    }
    for (const auto& [simd, name] : simds)
      for (const int64_t threads : {1, 2})
        add((std::string("ItemBuffers/") + name).c_str(), BM_ItemBuffers, {n, threads, simd});
    add("ItemBuffers/Embree", BM_ItemBuffersEmbree, {n});
  }
  add("ReadMemory", BM_ReadMemory, {int64_t(256) << 20});
  add("CopyMemory", BM_CopyMemory, {int64_t(256) << 20});
  add("ReadCache", BM_ReadMemory, {int64_t(256) << 10});
  benchmark::RegisterBenchmark("MultiplyAdd", BM_MultiplyAdd)->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
