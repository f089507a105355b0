"""Pictures of sphere meshes and panels."""
