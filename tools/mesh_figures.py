"""The figures by which meshes are compared, out of what `anatomesh check --image --json` measures."""

LARGE_TISSUE_VOX = 5000  # above it distances and volumes are promised
SMALL_TISSUE_VOX = 50    # up to it the number of parts is not


def figures(assessment):
    """Of a whole mesh. Lists are smallest and largest, smallest and mean, mean and 95 %, or edges and vertices."""
    whole, summary = assessment["whole"], assessment["summary"]
    quality = whole["quality"]
    tissues = [t for t in assessment["tissues"] if t["in_image"]]
    large = [t for t in tissues if t["fidelity"]["image_voxels"] > LARGE_TISSUE_VOX]
    counted = [t for t in tissues if t["fidelity"]["image_voxels"] > SMALL_TISSUE_VOX]
    return {
        "tets": quality["tets"],
        "dihedral_deg": [quality["min_dihedral_deg"], quality["max_dihedral_deg"]],
        "dihedral_p1_deg": quality["dihedral_p1_deg"],
        "mean_ratio": [quality["min_mean_ratio"], quality["mean_mean_ratio"]],
        "dice": [summary["min_dice"], summary["mean_dice"]],
        "surface_mm": [summary["surface_mean_mm"], summary["surface_p95_worst_mm"]],
        "large_surface_mm": [worst(t["fidelity"]["distance"]["mean_mm"] for t in large),
                             worst(t["fidelity"]["distance"]["p95_mm"] for t in large)],
        "large_volume_percent": worst(t["fidelity"]["volume_error_percent"] for t in large),
        "normal_jump_deg": summary["normal_jump_mean_deg"],
        "nonmanifold": [summary["nonmanifold_edges"], summary["nonmanifold_vertices"]],
        "wrong_parts": sum(t["topology"]["tet_components"] != t["topology"]["image_components_26"] for t in counted),
        "missing_labels": len(summary["missing_labels"]),
        "tissues": len(tissues),
        "image_volume_mm3": whole["fidelity"]["image_volume_mm3"],
    }


def worst(values):
    """The value of the largest magnitude; None without values, or where one could not be measured."""
    values = list(values)
    return None if not values or None in values else max(values, key=abs)
