# The version goes into every work unit's hash and into the manifest.
target_compile_definitions(promenade_preprocess PRIVATE PROMENADE_VERSION="${PROJECT_VERSION}")
