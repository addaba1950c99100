#include "layout/storage_probe.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/temporary_folder.h"

namespace promenade {
namespace {

TEST(StorageProbe, is_the_line_through_two_sizes_of_reads) {
  // 5 ms before a read, 100 MB/s.
  const StorageProfile profile = profile_of_reads(4096, 0.005 + 4096 / 100e6, 4 << 20, 0.005 + (4 << 20) / 100e6);
  EXPECT_NEAR(profile.seek_s, 0.005, 1e-9);
  EXPECT_NEAR(profile.bytes_per_s, 100e6, 1);
  EXPECT_EQ(profile.block_bytes, 4096U);
  EXPECT_EQ(profile.name, "measured");
}

TEST(StorageProbe, stays_finite_when_large_reads_take_no_longer) {
  const StorageProfile profile = profile_of_reads(4096, 0.001, 1 << 20, 0.001);
  EXPECT_TRUE(std::isfinite(profile.bytes_per_s));
  EXPECT_GT(profile.bytes_per_s, 0);
  EXPECT_GT(profile.seek_s, 0);
}

TEST(StorageProbe, measures_a_folder_and_leaves_nothing_there) {
  const TemporaryFolder folder;
  JobMonitor monitor;
  const Result<StorageProfile> profile = measure_storage(folder.path(), {1 << 20, 8, 4, 64 << 10}, monitor);
  ASSERT_TRUE(profile.ok()) << profile.error().message;
  EXPECT_GT(profile->seek_s, 0);
  EXPECT_GT(profile->bytes_per_s, 0);
  EXPECT_GE(profile->block_bytes, 512U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(StorageProbe, names_a_folder_that_is_not_there) {
  JobMonitor monitor;
  const Result<StorageProfile> profile = measure_storage("no/such/folder", ProbeOptions(), monitor);
  ASSERT_FALSE(profile.ok());
  EXPECT_NE(profile.error().message.find("no/such/folder"), std::string::npos);
}

}  // namespace
}  // namespace promenade
