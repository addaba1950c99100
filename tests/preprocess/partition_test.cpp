#include "preprocess/partition.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "tests/preprocess/import_fixtures.h"
#include "tests/preprocess/surfaces.h"

namespace promenade {
namespace {

std::vector<TriangleSample> samples_of(const Mesh& mesh) {
  std::vector<TriangleSample> samples;
  for (size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::vec3 a = mesh.positions[mesh.indices[3 * t]], b = mesh.positions[mesh.indices[3 * t + 1]],
                    c = mesh.positions[mesh.indices[3 * t + 2]];
    const float edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    samples.push_back({glm::dvec3(a + b + c) / 3.0, edge, glm::length(glm::cross(b - a, c - a)) / 2, t});
  }
  return samples;
}

ChunkTree tree_over(const Mesh& mesh, uint32_t chunk_triangles) {
  std::vector<TriangleSample> samples = samples_of(mesh);
  return divide_into_chunks(samples, {mesh.triangle_count(), chunk_triangles, 100, {4}, glm::dvec3(0)});
}

TEST(ChunkTree, is_one_chunk_for_few_triangles) {
  const ChunkTree tree = tree_over(test::hills(10), 1000);
  EXPECT_EQ(tree.chunks(), 1);
  EXPECT_EQ(tree.root, ChunkTree::kChunk);
  EXPECT_EQ(tree.first_plane, ChunkTree::kChunk);
}

TEST(ChunkTree, divides_so_that_chunks_are_filled_evenly) {
  const Mesh mesh = test::hills(100);
  const ChunkTree tree = tree_over(mesh, 1000);
  uint64_t routed = 0;
  for (const auto& [chunk, piece] : route(mesh, tree)) {
    EXPECT_LT(piece.triangle_count(), 1100) << "chunk " << chunk;
    EXPECT_GT(piece.triangle_count(), 400) << "chunk " << chunk;
    routed += piece.triangle_count();
  }
  EXPECT_EQ(routed, mesh.triangle_count()) << "small triangles stay whole";
}

TEST(ChunkTree, sends_triangles_that_coincide_to_several_chunks) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  for (int i = 0; i < 4000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  const ChunkTree tree = tree_over(mesh, 1000);
  uint64_t routed = 0;
  for (const auto& [chunk, piece] : route(mesh, tree)) {
    EXPECT_LE(piece.triangle_count(), 1100);
    routed += piece.triangle_count();
  }
  EXPECT_EQ(routed, 4000);
}

TEST(Route, cuts_what_is_much_larger_than_its_leaf) {
  Mesh mesh = test::hills(60);
  const ChunkTree tree = tree_over(mesh, 1000);
  const Mesh ground = test::flat_grid(1, 100, -10);
  double area_m2 = 0;
  for (const auto& [chunk, piece] : route(ground, tree)) {
    area_m2 += surface_area_m2(piece);
    const Box& cell = tree.chunk_cells[chunk];
    EXPECT_TRUE(cell.grown(tree.cut_step_m).contains(bounds(piece))) << "chunk " << chunk;
  }
  EXPECT_NEAR(area_m2, 10'000, 0.1);
}

class Spill : public testing::Test {
 protected:
  TemporaryFolder folder;
  Result<WorkFolder> work = WorkFolder::open(folder.path() / "work", real_file_system());
};

TEST_F(Spill, gives_back_each_chunks_triangles_in_order) {
  Result<SpillWriter> writer = SpillWriter::create(*work, 3, 4000);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  Mesh expected[3];
  for (uint32_t i = 0; i < 30; ++i) {
    const Mesh piece = test::flat_grid(1 + i % 5, float(i + 1));
    append(expected[i % 2 * 2], piece);
    ASSERT_TRUE(writer->add(i % 2 * 2, piece).ok());
  }
  const Result<SpillIndex> index = writer->finish();
  ASSERT_TRUE(index.ok()) << index.error().message;
  EXPECT_GT(index->chunks[0].blocks.size(), 1) << "the small buffer forces several blocks";
  const Result<RandomAccessFile> file = work->open_unit(kSpillFile);
  ASSERT_TRUE(file.ok());
  for (size_t chunk = 0; chunk < 3; ++chunk) {
    const Result<Mesh> mesh = read_spill(*file, index->chunks[chunk]);
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    EXPECT_EQ(mesh->positions, expected[chunk].positions);
    EXPECT_EQ(mesh->indices, expected[chunk].indices);
    EXPECT_EQ(index->chunks[chunk].triangles, expected[chunk].triangle_count());
  }
}

TEST_F(Spill, notices_a_damaged_block) {
  Result<SpillWriter> writer = SpillWriter::create(*work, 1, 1 << 20);
  ASSERT_TRUE(writer->add(0, test::hills(10)).ok());
  Result<SpillIndex> index = writer->finish();
  ASSERT_TRUE(index.ok());
  ++index->chunks[0].blocks[0].offset, --index->chunks[0].blocks[0].bytes;
  const Result<RandomAccessFile> file = work->open_unit(kSpillFile);
  EXPECT_FALSE(read_spill(*file, index->chunks[0]).ok());
}

TEST_F(Spill, work_unit_counts_only_with_its_own_hash_and_undamaged) {
  const std::vector<std::byte> payload(100, std::byte(7));
  ASSERT_TRUE(work->store("unit", 42, payload).ok());
  EXPECT_EQ(work->load("unit", 42), payload);
  EXPECT_EQ(work->load("unit", 43), std::nullopt);
  EXPECT_EQ(work->load("other", 42), std::nullopt);
  std::vector<std::byte> bytes = *read_file(work->path_of("unit"));
  bytes[60] = std::byte(8);
  ASSERT_TRUE(write_file(work->path_of("unit"), bytes).ok());
  EXPECT_EQ(work->load("unit", 42), std::nullopt);
}

TEST(MemoryBudget, refuses_too_little_memory_and_says_how_much_is_needed) {
  const Result<MemoryBudget> little = plan_memory({uint64_t(100) << 20, 2, 2000, {4}, 0});
  ASSERT_FALSE(little.ok());
  EXPECT_EQ(little.error().message, "--memory 100 MiB is too little to build with; give at least 256 MiB");
  const Result<MemoryBudget> large_nodes = plan_memory({uint64_t(256) << 20, 2, 60000, {16}, 0});
  ASSERT_FALSE(large_nodes.ok());
  EXPECT_NE(large_nodes.error().message.find("needs --memory"), std::string::npos);
}

TEST(MemoryBudget, decides_what_affects_bytes_without_looking_at_threads) {
  const Result<MemoryBudget> one = plan_memory({uint64_t(4) << 30, 1, 2000, {4}, 0});
  const Result<MemoryBudget> many = plan_memory({uint64_t(4) << 30, 64, 2000, {4}, 0});
  EXPECT_EQ(one->chunk_triangles, many->chunk_triangles);
  EXPECT_EQ(one->samples, many->samples);
}

}  // namespace
}  // namespace promenade
