#pragma once
// The first look at a source: every part once, to learn what decides the shape of the model.

#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "layout/footprints.h"
#include "preprocess/chunk_tree.h"
#include "preprocess/import.h"
#include "preprocess/memory_budget.h"
#include "preprocess/texture_store.h"

namespace promenade {

/// The materials of all parts in one table, each value once.
class MaterialTable {
 public:
  uint32_t add(const Material& material);
  const std::vector<Material>& materials() const { return materials_; }

 private:
  std::vector<Material> materials_;
  std::map<std::tuple<uint32_t, uint32_t, uint8_t, uint8_t, uint8_t, uint8_t, bool>, uint32_t> known_;
};

/// A part as the survey saw it.
struct SurveyedPart {
  SourcePart part;
  uint64_t hash = 0;                    ///< of everything imported from it that the model shows
  uint64_t triangles = 0;               ///< instances counted each
  std::vector<uint32_t> material_of;    ///< the part's material -> MaterialTable; kUnusedMaterial where no mesh uses it
  std::shared_ptr<const Scene> cached;  ///< kept while memory lasts
};
constexpr uint32_t kUnusedMaterial = 0xffffffffU;

/// What hangs on one joint of a part, and moves as one.
struct SurveyedObject {
  uint32_t part = 0;   ///< into Survey::parts
  uint32_t joint = 0;  ///< into Survey::animation
  std::vector<uint32_t> instances;
  glm::dmat4 joint_from_object{1.0};  ///< as in MovingObject
};

struct Survey {
  std::vector<SurveyedPart> parts;
  DBox world_box;
  glm::dvec3 origin{0};  ///< model = world - origin
  uint64_t triangles = 0;
  uint64_t moving_triangles = 0;        ///< of these
  std::vector<TriangleSample> samples;  ///< of what stands still
  Animation animation;
  std::vector<SurveyedObject> objects;      ///< that move; by part
  std::map<std::string, uint32_t> classes;  ///< numbered as they are met
  uint32_t class_of(const std::string& name) const { return classes.at(name); }
  Footprints footprints;  ///< of what the source says is solid; model space
  MaterialTable materials;
  ImportReport report;
  uint64_t hash = 0;  ///< of all parts
};

/// Imports every part, several at once as far as memory goes. Errors: import's, a part too large for the memory, no
/// triangles at all, cancellation.
Result<Survey> survey_source(const std::vector<SourcePart>& parts, const ImportOptions& options,
                             const MemoryBudget& budget, TextureStore& textures, JobMonitor& monitor);

/// The part's scene again, from memory or from its file. Error: import's, or the file has changed since the survey.
Result<std::shared_ptr<const Scene>> scene_of(const SurveyedPart& part, const ImportOptions& options,
                                              JobMonitor& monitor);

/// Bytes that a scene holds.
uint64_t byte_size(const Scene& scene);

/// What a cancelled build says.
constexpr const char* kInterrupted = "interrupted; run the same command to go on";

}  // namespace promenade
