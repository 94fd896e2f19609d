"""Pictures of radiance: files, arithmetic, false colour, tone mapping."""
