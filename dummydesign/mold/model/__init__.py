"""What a mould is, without CAD: specification, presets, layout, volumes and limits."""
